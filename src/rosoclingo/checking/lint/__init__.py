"""What may be wrong with a program, one file for each family of findings; :mod:`.kinds` has the table of them."""
