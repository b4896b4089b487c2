"""gringo 3's language, in which programs for oClingo are written: told from clingo 5's and translated into it.

What differs and how it is translated is told in ``doc/gringo3.md``.
"""

from rosoclingo.oclingo.gringo3.dialect import Dialect
from rosoclingo.oclingo.gringo3.lexer import TranslationError
from rosoclingo.oclingo.gringo3.translate import TranslationResult, included_files, translate, translate_program

__all__ = ["Dialect", "TranslationError", "TranslationResult", "included_files", "translate", "translate_program"]
