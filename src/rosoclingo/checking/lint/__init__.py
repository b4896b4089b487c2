"""The linter: likely errors of a program, in one module for each family; :mod:`.kinds` lists all kinds."""
