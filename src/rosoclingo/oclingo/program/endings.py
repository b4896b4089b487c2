"""Where a statement that clingo cannot read was meant to end: a comma that stands for a dot, a dot that is not there.

clingo reports such a fault where it cannot go on, which is in the next statement, at times lines below.
"""

from dataclasses import replace
from typing import Sequence

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.gringo3.dialect import accepted_by_clingo
from rosoclingo.oclingo.gringo3.lexer import SourceToken, TokenKind, tokens

_BREAKS = (TokenKind.DIRECTIVE, TokenKind.END)


def ended_before(fault: Fault, text: str) -> Fault:
    """Return a fault of clingo's parser at the place where a dot makes two statements of one; else as it is."""
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
            what = "a comma stands" if is_comma else "a dot is missing"
            message = f"{what} where a statement ends: what follows, up to {found[at].line}:{found[at].column}, is of"
            column = mark.column + (0 if is_comma else len(mark.text))
            return replace(fault, line=mark.line, column=column, message=f"{message} another one", mend="write a dot")
    return fault


def _accepted(statement: Sequence[SourceToken]) -> bool:
    """Return whether tokens with a dot behind them are a statement."""
    return bool(statement) and accepted_by_clingo(" ".join(one.text for one in statement) + ".")
