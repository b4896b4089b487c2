"""Watches the order of ``#const``: gringo 3 replaces a constant only in what follows, today's solver everywhere."""

from typing import Dict, List, Sequence, Tuple

from rosoclingo.oclingo.gringo3.faults import RefusalError
from rosoclingo.oclingo.gringo3.lexer import Kind, Token

_ARITHMETIC = {"+", "-", "*", "/", "\\", "**", "..", "&", "^", "?", "~", "|", "#mod", "#div", "#pow"}
_COMPARISONS = {"=", ":=", "==", "!=", "<", "<=", ">", ">="}


class Constants:
    """Notes where names are used as terms before ``#const`` gives them a value."""

    def __init__(self) -> None:
        self._used: Dict[str, Tuple[str, Token]] = {}

    def note(self, file: str, statement: Sequence[Token]) -> None:
        """Note the names that a statement uses as terms.

        Names inside arithmetic do not count: there gringo 3 stops at a name without a value, so that no program can
        mean anything else than today's solver takes it for.
        """
        for token in _names(statement):
            self._used.setdefault(token.text, (file, token))

    def define(self, token: Token, name: str) -> None:
        """Note a ``#const``; :class:`RefusalError` if a statement before it uses the name."""
        if name in self._used:
            file, use = self._used[name]
            message = f"gringo 3 does not replace '{name}' in the statements before this #const, but clingo 5 does"
            raise RefusalError(token, message, f"put the #const before its use in {file}:{use.line}")


def _names(statement: Sequence[Token]) -> List[Token]:
    found, depth = [], 0
    for before, token, after in zip(("", *(t.text for t in statement)), statement, (*statement[1:], statement[-1])):
        depth += {"(": 1, ")": -1}.get(token.text, 0)
        around = {before, after.text}
        is_term = depth > 0 or around & _COMPARISONS
        if token.kind is Kind.IDENTIFIER and after.text != "(" and is_term and not around & _ARITHMETIC:
            found.append(token)
    return found
