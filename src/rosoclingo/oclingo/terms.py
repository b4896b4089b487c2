"""Ground terms and atoms as text: parsed as data into :class:`clingo.Symbol`, never evaluated.

The grammar is that of oClingo's online progressions: identifiers, "strings", integers, ``f(terms)``; atoms may carry
classical negation (``-p(1)``).
"""

from typing import List, Optional, Tuple

import clingo

from rosoclingo.oclingo.errors import ProgressionError
from rosoclingo.oclingo.tokens import Token, TokenStream

MAX_DEPTH = 256
"""Deepest nesting of terms that is read; far beyond any use, and safe for the recursion in clingo."""

_LOWEST, _HIGHEST = -(2**31), 2**31 - 1
_ESCAPES = {"\\n": "\n", '\\"': '"', "\\\\": "\\"}


def parse_term(text: str) -> clingo.Symbol:
    """Return the one ground term that ``text`` holds.

    Raises ProgressionError (line and column from 1) for anything else.
    """
    tokens = TokenStream(text)
    term = read_term(tokens)
    _expect_end(tokens)
    return term


def parse_atom(text: str) -> clingo.Symbol:
    """Return the one ground atom that ``text`` holds (``p``, ``-p``, ``p(terms)``); a trailing ``.`` is accepted.

    Raises ProgressionError (line and column from 1) for anything else.
    """
    tokens = TokenStream(text)
    atom = read_atom(tokens)
    tokens.accept(".")
    _expect_end(tokens)
    return atom


def read_atom(tokens: TokenStream) -> clingo.Symbol:
    """Read an atom from ``tokens``."""
    positive = not tokens.accept("-")
    if tokens.next.kind != "name" or tokens.at("not"):
        tokens.fail("expected an atom: a name in lower case, like p or p(1)")
    name = tokens.take()
    return clingo.Function(name.text, _read_arguments(tokens, name), positive)


def read_term(tokens: TokenStream) -> clingo.Symbol:
    """Read a term from ``tokens``."""
    simple = _read_simple(tokens)
    if simple is not None:
        return simple
    name = tokens.take()
    return clingo.Function(name.text, _read_arguments(tokens, name))


def read_number(tokens: TokenStream, what: str) -> int:
    """Read a number without sign; ``what`` names it in the error."""
    if tokens.next.kind != "number":
        tokens.fail(f"expected {what}, a number")
    return _number(tokens.take(), 1)


def _read_simple(tokens: TokenStream) -> Optional[clingo.Symbol]:
    """Read a string or an integer; None where a name follows."""
    if tokens.next.kind == "string":
        return clingo.String(_unescape(tokens.take().text[1:-1]))
    sign = -1 if tokens.accept("-") else 1
    if tokens.next.kind == "number":
        return clingo.Number(_number(tokens.take(), sign))
    if sign == -1:
        tokens.fail("expected a number behind '-'")
    if tokens.next.kind != "name" or tokens.at("not"):
        tokens.fail('expected a ground term: a name in lower case, an integer, a "string" or f(terms)')
    return None


def _read_arguments(tokens: TokenStream, name: Token) -> List[clingo.Symbol]:
    """Read ``(terms)`` behind ``name``, where there is one, without recursion in depth."""
    if not tokens.at("("):
        return []
    tokens.take()
    stack: List[Tuple[str, List[clingo.Symbol]]] = [(name.text, [])]
    while True:
        value = _read_simple(tokens)
        if value is None:
            token = tokens.take()
            if tokens.accept("("):
                _check_depth(len(stack), token)
                stack.append((token.text, []))
                continue
            value = clingo.Function(token.text)
        stack[-1][1].append(value)
        while tokens.accept(")"):
            function, arguments = stack.pop()
            if not stack:
                return arguments
            stack[-1][1].append(clingo.Function(function, arguments))
        tokens.expect(",", "or ')' behind an argument")


def _check_depth(depth: int, token: Token) -> None:
    if depth >= MAX_DEPTH:
        raise ProgressionError(token.line, token.column, f"term nested deeper than {MAX_DEPTH} levels")


def _number(token: Token, sign: int) -> int:
    # the length is looked at first: int() refuses or labours on texts of thousands of digits
    value = sign * int(token.text) if len(token.text.lstrip("0")) <= 10 else None
    if value is None or not _LOWEST <= value <= _HIGHEST:
        text = token.text if len(token.text) <= 20 else token.text[:20] + "..."
        limits = f"numbers go from {_LOWEST} to {_HIGHEST}"
        raise ProgressionError(token.line, token.column, f"number {text} does not fit in 32 bits; {limits}")
    return value


def _unescape(text: str) -> str:
    if "\\" not in text:
        return text
    parts, index = [], 0
    while index < len(text):
        pair = text[index : index + 2]
        parts.append(_ESCAPES.get(pair, text[index]))
        index += 2 if pair in _ESCAPES else 1
    return "".join(parts)


def _expect_end(tokens: TokenStream) -> None:
    if tokens.next.kind != "end":
        tokens.fail("expected one ground term or atom and nothing behind it")
