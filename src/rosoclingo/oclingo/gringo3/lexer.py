"""A lexer for logic programs in the languages of gringo 3 and clingo 5.

The lexer never fails: invalid text becomes tokens of kind :attr:`TokenKind.UNKNOWN`, which no grammar rule accepts. It
skips white space and comments; the offsets of the tokens show their places.
"""

import enum
import re
from functools import lru_cache
from typing import Iterator, List, NamedTuple, Sequence, Tuple

from rosoclingo.oclingo.errors import ProgramError


class TokenKind(enum.Enum):
    """The kind of a token."""

    IDENTIFIER = "identifier"
    VARIABLE = "variable"
    ANONYMOUS = "anonymous variable"
    NUMBER = "number"
    BASED_NUMBER = "number with a base"
    STRING = "string"
    DIRECTIVE = "directive"
    SYMBOL = "symbol"
    SCRIPT = "script"
    UNKNOWN = "unknown"
    END = "end of file"


class SourceToken(NamedTuple):
    """A token; offsets are in characters, lines and columns count from 1."""

    kind: TokenKind
    text: str
    start: int
    end: int
    line: int
    column: int

    def shown(self) -> str:
        """Return the token's text for messages."""
        return "the end of the file" if self.kind is TokenKind.END else "'{}'".format(self.text.split("\n")[0][:40])


_TOKEN = re.compile(
    r"""
    (?P<SPACE>[ \t\r\n\f\v]+)
  | (?P<LINE_COMMENT>%(?!\*)[^\n]*)
  | (?P<BLOCK_COMMENT>%\*)
  | (?P<SCRIPT>\#begin_lua.*?\#end_lua[ \t\r]*\. | \#script\s*\(\s*\w+\s*\).*?\#end\s*\.)
  | (?P<DIRECTIVE>\#sum\+ | \#[A-Za-z_][A-Za-z0-9_]*)
  | (?P<BASED_NUMBER>0x[0-9A-Fa-f]+ | 0o[0-7]+ | 0b[01]+)
  | (?P<NUMBER>0 | [1-9][0-9]*)
  | (?P<IDENTIFIER>_*[a-z]['A-Za-z0-9_]*)
  | (?P<VARIABLE>_*[A-Z]['A-Za-z0-9_]*)
  | (?P<ANONYMOUS>_(?![A-Za-z0-9_']))
  | (?P<STRING>"(?:[^\\"\n] | \\["\\n])*")
  | (?P<SYMBOL>;; | := | :- | :~ | \.\. | \*\* | <= | >= | == | != | [][(){}.,;:|+\-*/\\<>=@&?^~!$])
    """,
    re.VERBOSE | re.DOTALL,
)
_KINDS = dict(TokenKind.__members__)
_COMMENT_MARKS = re.compile(r"%\*|\*%|%[^\n]*")


def tokens(text: str) -> Sequence[SourceToken]:
    """Return all tokens of a text; the last one is of kind :attr:`TokenKind.END`."""
    return _pieces(text)[0]


def comments(text: str) -> Sequence[str]:
    """Return all line comments of a text, without the leading ``%``."""
    return _pieces(text)[1]


def statements(all_tokens: Sequence[SourceToken]) -> Iterator[Tuple[int, int]]:
    """Yield the token ranges ``(first, after)`` of the statements; each includes its dot if it has one."""
    first = 0
    while all_tokens[first].kind is not TokenKind.END:
        after = _after_dot(all_tokens, first)
        yield first, after
        first = after


def _after_dot(all_tokens: Sequence[SourceToken], first: int) -> int:
    """Return the index after a statement, including a weight or value after its dot."""
    if all_tokens[first].kind is TokenKind.SCRIPT:
        return first + 1
    index, theory = first, all_tokens[first].text == "#theory"
    while all_tokens[index].kind is not TokenKind.END:
        if index > first and all_tokens[index].text in _BEGINNINGS:
            return index
        if all_tokens[index].text == "." and (not theory or all_tokens[index - 1].text == "}"):
            return _after_weight(all_tokens, all_tokens[first].text, index + 1)
        index += 1
    return index


def _after_weight(all_tokens: Sequence[SourceToken], word: str, index: int) -> int:
    """Return the index after ``[...]``, or ``<...>`` for gringo 3, if it belongs to the statement before."""
    closing = {"[": "]", "<": ">"}.get(all_tokens[index].text)
    weighs = word == ":~" or (word == "#heuristic" and closing == "]")
    if not closing or not (weighs or (word == "#external" and all_tokens[index + 1].text in _VALUES)):
        return index
    while all_tokens[index].text not in (closing, ".") and all_tokens[index].kind is not TokenKind.END:
        index += 1
    return min(index + 1, len(all_tokens) - 1)


_BEGINNINGS = ("#base", "#cumulative", "#volatile", "#forget", "#iinit", "#program")
"""Directives that begin a statement even if the statement before has no dot."""

_VALUES = ("true", "false", "free", "release")
"""The possible values in brackets after an ``#external``."""


@lru_cache(maxsize=32)  # includes, dialect, directives and checks need the tokens of the same text
def _pieces(text: str) -> Tuple[Sequence[SourceToken], Sequence[str]]:
    found: List[SourceToken] = []
    remarks: List[str] = []
    start, line, begin = 0, 1, 0  # offset of the line
    while start < len(text):
        match = _TOKEN.match(text, start)
        name, end = (str(match.lastgroup), match.end()) if match else ("UNKNOWN", start + 1)
        if name == "BLOCK_COMMENT":
            end = _end_of_comment(text, end)
            name, end = (name, end) if end > 0 else ("UNKNOWN", len(text))
        if name == "LINE_COMMENT":
            remarks.append(text[start + 1 : end])
        elif name in _KINDS:
            found.append(SourceToken(_KINDS[name], text[start:end], start, end, line, start - begin + 1))
        newlines = text.count("\n", start, end)
        if newlines:
            line, begin = line + newlines, text.rindex("\n", start, end) + 1
        start = end
    found.append(SourceToken(TokenKind.END, "", start, start, line, start - begin + 1))
    return found, remarks


def _end_of_comment(text: str, offset: int) -> int:
    """Return the end of a block comment that contains the offset, or -1; inside it, ``%`` comments out its line."""
    depth = 1
    for mark in _COMMENT_MARKS.finditer(text, offset):
        if mark.group() == "%*":
            depth += 1
        elif mark.group() == "*%":
            depth -= 1
        if depth == 0:
            return mark.end()
    return -1


class TranslationError(ProgramError):
    """A program cannot be translated; :attr:`faults` lists all places and reasons."""
