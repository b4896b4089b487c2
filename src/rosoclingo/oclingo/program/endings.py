"""Locates the missing dot, or the comma in place of a dot, that causes a syntax error.

clingo reports such an error where it cannot continue. That is in the next statement, which can be lines below.
"""

from dataclasses import replace
from typing import Sequence

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.gringo3.dialect import accepted_by_clingo
from rosoclingo.oclingo.gringo3.lexer import SourceToken, TokenKind, tokens

_BREAKS = (TokenKind.DIRECTIVE, TokenKind.END)


def locate_missing_dot(fault: Fault, text: str) -> Fault:
    """Move a syntax error to the place where a dot would separate two valid statements.

    Return any other fault unchanged.
    """
    if not fault.message.startswith("syntax error, unexpected"):
        return fault
    found = tokens(text)
    place = fault.line, fault.column
    at = next((n for n, one in enumerate(found) if (one.line, one.column) >= place), len(found) - 1)
    dots = [-1, *(n for n, one in enumerate(found) if one.text == "." or one.kind is TokenKind.END)]
    first = max(n for n in dots if n < at) + 1
    after = min(n for n in dots if n >= at)
    for n in range(at - 1, first - 1, -1):
        mark, behind = found[n], found[n + 1]
        is_comma, breaks = mark.text == ",", behind.kind in _BREAKS
        if not (is_comma or breaks or behind.line > mark.line):
            continue
        if _accepted(found[first : n + (not is_comma)]) and (breaks or _accepted(found[n + 1 : after])):
            problem = "a comma stands" if is_comma else "a dot is missing"
            end = f"{found[at].line}:{found[at].column}"
            message = f"{problem} where a statement ends: the text up to {end} belongs to the next statement"
            column = mark.column + (0 if is_comma else len(mark.text))
            return replace(fault, line=mark.line, column=column, message=message, remedy="write a dot")
    return fault


def _accepted(statement: Sequence[SourceToken]) -> bool:
    """Return whether tokens form a statement if a dot follows."""
    return bool(statement) and accepted_by_clingo(" ".join(one.text for one in statement) + ".")
