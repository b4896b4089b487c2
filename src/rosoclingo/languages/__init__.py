"""Languages in which files of a program may be written, beside answer set programming; PURE.

A file NAME.xyz is in the language of the module ``rosoclingo.languages.xyz`` here, if there is one. Its function
``translate(text, name)`` returns a :class:`~rosoclingo.oclingo.program.languages.Translation`, or raises
:class:`~rosoclingo.oclingo.ProgramError` with all faults of the text. That is all that it takes: the solver, ``check``,
launch files and recordings read such a file like any other.
"""
