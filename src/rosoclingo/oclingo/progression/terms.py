"""Ground terms and atoms: read from text as data into :class:`clingo.Symbol`, never evaluated; and their signatures.

The tokens are those of whole online progressions, with line and column; :mod:`~rosoclingo.oclingo.progression.parser`
reads statements and directives of them. The grammar of terms is oClingo's: identifiers, "strings", integers,
``f(terms)``; atoms may carry classical negation (``-p(1)``). What clingo's terms have besides is read too: tuples,
``-f(terms)``, ``#inf``, ``#sup``.
"""

import re
from dataclasses import dataclass, field
from typing import Iterator, List, NamedTuple, NoReturn, Optional, Tuple, Union

import clingo

from rosoclingo.oclingo.errors import ProgressionError

MAX_DEPTH = 256
"""Deepest nesting of terms that is read; far beyond any use, and safe for the recursion in clingo."""

_LOWEST, _HIGHEST = -(2**31), 2**31 - 1
_LIMITS = {"#inf": clingo.Infimum, "#sup": clingo.Supremum}
_TOKEN = re.compile(
    r"""
      (?P<space>[ \t\r\n\f\v]+ | %(?!\*)[^\n]*)
    | (?P<block>%\*)
    | (?P<string>"(?:[^"\\\n\0\ud800-\udfff]|\\["\\n])*")
    | (?P<number>[0-9]+)
    | (?P<name>[_']*[a-z][A-Za-z0-9_']*)
    | (?P<directive>\#end[ \t\r\n]+step\b | \#[a-z]+)
    | (?P<symbol>:-|\.\.|[.,:()-])
    """,
    re.VERBOSE,
)
_VARIABLE = re.compile(r"[_']*[A-Z][A-Za-z0-9_']*|_")
_ODD_STRING = re.compile(r'"(?:[^"\\\n]|\\["\\n])*"')
_BLOCK_EDGE = re.compile(r"%\*|\*%")
_ESCAPES = {"\\n": "\n", '\\"': '"', "\\\\": "\\"}


class Signature(NamedTuple):
    """Name, arity and sign (False under classical negation) of a predicate."""

    name: str
    arity: int
    positive: bool = True

    def __str__(self) -> str:
        return "{}{}/{}".format("" if self.positive else "-", self.name, self.arity)


def signature_of(atom: clingo.Symbol) -> Signature:
    """Return the signature of a ground atom."""
    return Signature(atom.name, len(atom.arguments), atom.positive)


class Token(NamedTuple):
    """A token: its kind (``string``, ``number``, ``name``, ``directive``, ``symbol`` or ``end``), text and place."""

    kind: str
    text: str
    line: int
    column: int


class _Place:
    """Turns offsets, asked for in rising order, into lines and columns (both from 1)."""

    def __init__(self, text: str) -> None:
        self._text, self._line, self._start, self._seen = text, 1, 0, 0

    def __call__(self, offset: int) -> Tuple[int, int]:
        self._line += self._text.count("\n", self._seen, offset)
        self._start = self._text.rfind("\n", 0, offset) + 1
        self._seen = offset
        return self._line, offset - self._start + 1


def _end_of_block(text: str, start: int) -> int:
    """Return the offset behind the (nested) block comment at ``start``, or -1 where it is not closed."""
    depth = 0
    for edge in _BLOCK_EDGE.finditer(text, start):
        depth += 1 if edge.group() == "%*" else -1
        if depth == 0:
            return edge.end()
    return -1


def _complaint(text: str, offset: int) -> str:
    if _ODD_STRING.match(text, offset):
        return "string with a character that is no text (NUL or half of a surrogate pair)"
    if text[offset] == '"':
        return 'string without end; close it with " on the same line (escapes are \\", \\\\ and \\n)'
    variable = _VARIABLE.match(text, offset)
    if variable:
        return _of_variable(variable.group(), text[variable.end() : variable.end() + 1] == "(")
    return f"unexpected character {text[offset]!r}"


def _of_variable(name: str, with_arguments: bool) -> str:
    first = len(name) - len(name.lstrip("_'"))
    small = name[: first + 1].lower() + name[first + 1 :]
    if name == "_":
        return "_ is a variable: write a value in its place"
    if with_arguments:
        return f"{name} begins with a capital letter, as only variables do: write {small}"
    return f'{name} is a variable, since it begins with a capital letter: write a value, such as {small} or "{name}"'


def scan(text: str) -> Iterator[Token]:
    """Yield the tokens of ``text``, an ``end`` token last; raise :class:`ProgressionError` at what is none."""
    place, offset = _Place(text), 0
    while offset < len(text):
        match = _TOKEN.match(text, offset)
        if match is None:
            raise ProgressionError(*place(offset), _complaint(text, offset))
        kind = str(match.lastgroup)
        if kind == "block":
            end = _end_of_block(text, offset)
            if end < 0:
                raise ProgressionError(*place(offset), "comment without end; close it with *%")
            offset = end
            continue
        if kind != "space":
            yield Token(kind, match.group(), *place(offset))
        offset = match.end()
    yield Token("end", "", *place(len(text)))


class TokenStream:
    """The tokens of a text, read one by one with one token of look-ahead."""

    def __init__(self, text: str) -> None:
        self._tokens = scan(text)
        self.next = next(self._tokens)

    def take(self) -> Token:
        """Return the next token and move on (the ``end`` token stays)."""
        token = self.next
        if token.kind != "end":
            self.next = next(self._tokens)
        return token

    def at(self, *texts: str) -> bool:
        """Tell whether the next token is a symbol, name or directive with one of ``texts`` (strings have quotes)."""
        return self.next.text in texts

    def accept(self, text: str) -> bool:
        """Take the next token if it is ``text``."""
        if self.at(text):
            self.take()
            return True
        return False

    def expect(self, text: str, where: str) -> Token:
        """Take ``text`` or raise :class:`ProgressionError` saying that it is missing ``where``."""
        if not self.at(text):
            self.fail(f"expected {text!r} {where}")
        return self.take()

    def fail(self, message: str) -> NoReturn:
        """Raise :class:`ProgressionError` at the next token."""
        found = "found the end" if self.next.kind == "end" else f"found {shorten(self.next.text)}"
        raise ProgressionError(self.next.line, self.next.column, f"{message}, {found}")


def shorten(text: str, limit: int = 60) -> str:
    """Return ``text`` quoted for a message, cut to about ``limit`` characters."""
    return repr(text) if len(text) <= limit else repr(text[:limit]) + "..."


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
    name = tokens.take().text
    return _read_compound(tokens, _Compound(name, positive)) if tokens.accept("(") else _function(name, [], positive)


def read_term(tokens: TokenStream) -> clingo.Symbol:
    """Read a term from ``tokens``."""
    value = _read_simple(tokens)
    return _read_compound(tokens, value) if isinstance(value, _Compound) else value


def read_number(tokens: TokenStream, what: str) -> int:
    """Read a number without sign; ``what`` names it in the error."""
    if tokens.next.kind != "number":
        tokens.fail(f"expected {what}, a number")
    return _number(tokens.take(), 1)


@dataclass
class _Compound:
    """A function, or a tuple where it has no name, whose arguments are being read."""

    name: str
    positive: bool = True
    arguments: List[clingo.Symbol] = field(default_factory=list)
    comma: bool = False

    def value(self) -> clingo.Symbol:
        """Return the symbol; a term in brackets is no tuple without a comma."""
        if not self.name and len(self.arguments) == 1 and not self.comma:
            return self.arguments[0]
        return _function(self.name, self.arguments, self.positive)


def _function(name: str, arguments: List[clingo.Symbol], positive: bool = True) -> clingo.Symbol:
    return clingo.Function(name, arguments, positive)


def _read_simple(tokens: TokenStream) -> Union[clingo.Symbol, _Compound]:
    """Read a term as far as the bracket that begins its arguments, if it has any."""
    if tokens.next.kind == "string":
        return clingo.String(_unescape(tokens.take().text[1:-1]))
    if tokens.at(*_LIMITS):
        return _LIMITS[tokens.take().text]
    positive = not tokens.accept("-")
    if tokens.next.kind == "number":
        return clingo.Number(_number(tokens.take(), 1 if positive else -1))
    if tokens.next.kind == "name" and not tokens.at("not"):
        name = tokens.take().text
        return _Compound(name, positive) if tokens.accept("(") else _function(name, [], positive)
    if not positive:
        tokens.fail("expected a number or a name behind '-'")
    if not tokens.accept("("):
        tokens.fail('expected a term: a name in lower case, an integer, a "string", f(terms) or a tuple')
    return _Compound("")


def _read_compound(tokens: TokenStream, outermost: _Compound) -> clingo.Symbol:
    """Read the arguments of ``outermost`` and its end, without recursion in depth."""
    stack = [outermost]
    while True:
        value: Optional[clingo.Symbol] = None
        inner = stack[-1]
        if not (tokens.at(")") and not inner.name and (inner.comma or not inner.arguments)):
            place = tokens.next
            read = _read_simple(tokens)
            if isinstance(read, _Compound):
                _check_depth(len(stack), place)
                stack.append(read)
                continue
            value = read
        while True:
            if value is not None:
                stack[-1].arguments.append(value)
            if not tokens.accept(")"):
                break
            value = stack.pop().value()
            if not stack:
                return value
        tokens.expect(",", "or ')' behind an argument")
        stack[-1].comma = True


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
        tokens.fail("expected one term or atom and nothing behind it")
