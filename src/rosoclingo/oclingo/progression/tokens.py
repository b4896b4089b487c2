"""Lexer of online progressions: ground terms, statements and directives, with line and column of every token."""

import re
from typing import Iterator, NamedTuple, NoReturn, Tuple

from rosoclingo.oclingo.errors import ProgressionError

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
        return f"variable {variable.group()}; an online progression is ground, write a value"
    return f"unexpected character {text[offset]!r}"


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
