"""Where a statement that clingo cannot read was meant to end: a comma that stands for a dot, a dot that is not there.

clingo tells such a fault where it cannot go on, which is in the next statement, at times lines below.
"""

from dataclasses import replace
from typing import List, Optional, Sequence, Tuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.gringo3.lexer import SourceToken, TokenKind, tokens

_SAID = "syntax error, unexpected"
_DEPTH = {"(": 1, "{": 1, "[": 1, ")": -1, "}": -1, "]": -1}
_BEGINNINGS = (TokenKind.IDENTIFIER, TokenKind.DIRECTIVE, TokenKind.END)


def ended_before(fault: Fault, text: str) -> Fault:
    """Return a fault of clingo's parser at the place where the statement before lacks its dot; else as it is."""
    if not fault.message.startswith(_SAID):
        return fault
    found = tokens(text)
    at = next((n for n, one in enumerate(found) if (one.line, one.column) >= (fault.line, fault.column)), 0)
    place = _end(found, at) if at else None
    if place is None:
        return fault
    mark, is_comma = place
    column = mark.column if is_comma else mark.column + len(mark.text)
    what = "a comma stands" if is_comma else "a dot is missing"
    behind = f"{found[at].line}:{found[at].column}"
    message = f"{what} where a statement ends: what follows, up to {behind}, is of another one"
    return replace(fault, line=mark.line, column=column, message=message, mend="write a dot")


def _end(found: Sequence[SourceToken], at: int) -> Optional[Tuple[SourceToken, bool]]:
    """Return the token at or behind which a dot belongs, and whether it stands in its place."""
    odd, before = found[at], found[at - 1]
    statement = _statement(found, at)
    if not statement or _depth(statement):
        return None
    if odd.text == ":-" and any(one.text == ":-" for one in statement):
        if before.text not in (",", ";") and before.line < odd.line:
            return before, False
        commas = _bare_commas(statement)
        return (commas[-1], True) if commas else None
    if odd.kind in (TokenKind.DIRECTIVE, TokenKind.END) and before.text == ",":
        return before, True
    if odd.kind in _BEGINNINGS and before.kind is not TokenKind.DIRECTIVE and _is_end(before, odd):
        return before, False
    return None


def _statement(found: Sequence[SourceToken], at: int) -> List[SourceToken]:
    """Return the tokens before ``at`` of its statement."""
    first = at
    while first and found[first - 1].text != ".":
        first -= 1
    return list(found[first:at])


def _depth(statement: Sequence[SourceToken]) -> int:
    return sum(_DEPTH.get(one.text, 0) for one in statement if one.kind is TokenKind.SYMBOL)


def _bare_commas(statement: Sequence[SourceToken]) -> List[SourceToken]:
    """Return the commas in a statement's body that stand in no bracket."""
    depth, commas, in_body = 0, [], False
    for one in statement:
        depth += _DEPTH.get(one.text, 0) if one.kind is TokenKind.SYMBOL else 0
        in_body = in_body or one.text == ":-"
        if one.text == "," and in_body and not depth:
            commas.append(one)
    return commas


def _is_end(before: SourceToken, odd: SourceToken) -> bool:
    """Tell whether a literal may end before a token that stands on another line."""
    closes = before.text in (")", "}") or before.kind in (TokenKind.IDENTIFIER, TokenKind.NUMBER, TokenKind.VARIABLE)
    return closes and (before.line < odd.line or odd.kind is not TokenKind.IDENTIFIER)
