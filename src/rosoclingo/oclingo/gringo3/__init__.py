"""Recognition of programs in gringo 3's language, which oClingo used, and their translation for clingo 5.

``doc/gringo3.md`` describes the differences and the translation.
"""

from rosoclingo.oclingo.gringo3.dialect import Dialect
from rosoclingo.oclingo.gringo3.lexer import TranslationError
from rosoclingo.oclingo.gringo3.translate import TranslationResult, included_files, translate, translate_program

__all__ = ["Dialect", "TranslationError", "TranslationResult", "included_files", "translate", "translate_program"]
