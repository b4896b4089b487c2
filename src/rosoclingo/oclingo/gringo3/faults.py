"""How the translator reports what it cannot translate."""

from rosoclingo.oclingo.errors import Fault, ProgramError
from rosoclingo.oclingo.gringo3.lexer import Token


class TranslationError(ProgramError):
    """A program cannot be translated faithfully; :attr:`faults` lists every place and reason."""


class RefusalError(Exception):
    """One statement cannot be translated; the translator collects these into a :class:`TranslationError`."""

    def __init__(self, token: Token, message: str, mend: str = "") -> None:
        self.token, self.message, self.mend = token, message, mend
        super().__init__(message)

    def fault(self, file: str) -> Fault:
        """The same with the file's name."""
        return Fault(file, self.token.line, self.token.column, self.message, self.mend)
