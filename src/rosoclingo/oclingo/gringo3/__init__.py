"""gringo 3's language, in which programs for oClingo are written: recognized, and translated into clingo 5's.

``doc/gringo3.md`` describes the differences and their translation.
"""

from rosoclingo.oclingo.gringo3.dialect import Dialect
from rosoclingo.oclingo.gringo3.lexer import TranslationError
from rosoclingo.oclingo.gringo3.translate import TranslationResult, included_files, translate, translate_program

__all__ = ["Dialect", "TranslationError", "TranslationResult", "included_files", "translate", "translate_program"]
