"""Conversion between ASP terms and plain Python values.  No ROS."""

import math
import re
from typing import Any

from clingo import Number, String, Symbol, SymbolType

from rosoclingo.oclingo import ProgressionError, parse_atom, parse_term

_NO_TEXT = re.compile("[\0\ud800-\udfff]")


class TermError(ValueError):
    """A text that is not a ground term, or a value that does not fit its field."""


def read_term(text: str) -> Symbol:
    """Parse a ground term.  Raises TermError."""
    try:
        return parse_term(text)
    except ProgressionError as error:
        raise TermError(f"{text!r} is not a ground term: {error.message}") from error


def read_atom(text: str) -> Symbol:
    """Parse a ground atom.  Raises TermError."""
    try:
        return parse_atom(text)
    except ProgressionError as error:
        raise TermError(f"{text!r} is not a ground atom: {error.message}") from error


def as_string(text: str) -> Symbol:
    """Return the ASP string of a text. NUL and lone surrogates, which no ASP string can hold, become U+FFFD."""
    return String(_NO_TEXT.sub("\ufffd", text))


def as_text(value: Any) -> str:
    """Return a value as plain text: the characters of an ASP string, any other term as clingo prints it."""
    if isinstance(value, Symbol):
        return value.string if value.type == SymbolType.String else str(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(value)


def as_term(value: Any) -> Symbol:
    """Return a value as a term: integers as numbers, the text of a term as that term, other text as a string."""
    if isinstance(value, Symbol):
        return value
    if isinstance(value, int) and not isinstance(value, bool):
        return Number(value)
    text = as_text(value)
    try:
        return read_term(text)
    except TermError:
        return as_string(text)


def as_integer(value: Any) -> int:
    """Return a value as an integer; strings are parsed.  Raises TermError."""
    if isinstance(value, Symbol) and value.type == SymbolType.Number:
        return value.number
    if isinstance(value, int) and not isinstance(value, bool):
        return value
    try:
        return int(as_text(value))
    except ValueError:
        raise TermError(f"{as_text(value)} is not an integer") from None


def as_real(value: Any) -> float:
    """Return a value as a finite number; ASP writes fractions as strings ("0.5").  Raises TermError."""
    try:
        number = float(value) if isinstance(value, (int, float)) else float(as_text(value))
    except ValueError:
        number = math.nan
    if isinstance(value, bool) or not math.isfinite(number):
        raise TermError(f"{as_text(value)} is not a finite number")
    return number


def as_boolean(value: Any) -> bool:
    """Return a value as a Boolean: true, false, 1 or 0.  Raises TermError."""
    text = as_text(value)
    if text in ("true", "1"):
        return True
    if text in ("false", "0"):
        return False
    raise TermError(f"{text} is neither true nor false")
