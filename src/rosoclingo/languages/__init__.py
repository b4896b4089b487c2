"""Languages in which files of a program may be written, beside answer set programming; PURE.

A file NAME.xyz is in the language of the module ``rosoclingo.languages.xyz`` here, if there is one. Its functions
``read`` and ``translate_files`` are told in :mod:`rosoclingo.oclingo.program.languages`. That is all that it takes: the
solver, ``check``, launch files and recordings read such a file like any other.
"""
