"""Tokens of logic programs, in gringo 3's language and in clingo 5's alike.

The lexer never fails: what is no token of either language becomes a token of kind :attr:`Kind.UNKNOWN`, which no rule
of the grammar accepts; what is refused is refused at a token. White space and comments are no tokens; their text is
found again by the tokens' offsets.
"""

import enum
import re
from functools import lru_cache
from typing import Iterator, List, NamedTuple, Sequence, Tuple

from rosoclingo.oclingo.errors import ProgramError


class Kind(enum.Enum):
    """What a token is."""

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


class Token(NamedTuple):
    """One token; offsets count characters of the text, lines and columns count from 1."""

    kind: Kind
    text: str
    start: int
    end: int
    line: int
    column: int

    def shown(self) -> str:
        """The token's text as a message shows it."""
        return "the end of the file" if self.kind is Kind.END else "'{}'".format(self.text.split("\n")[0][:40])


_TOKEN = re.compile(
    r"""
    (?P<SPACE>\s+)
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
_KINDS = dict(Kind.__members__)
_COMMENT_MARKS = re.compile(r"%\*|\*%|%[^\n]*")


def tokens(text: str) -> List[Token]:
    """All tokens of a text; the last one is of kind :attr:`Kind.END`."""
    return list(_tokens(text))


@lru_cache(maxsize=32)  # a program's texts are asked for several times, by what it includes and by its checks
def _tokens(text: str) -> Tuple[Token, ...]:
    found: List[Token] = []
    line, begin = 1, 0  # where the line begins
    for name, start, end in (*_scan(text), ("END", len(text), len(text))):
        if name in _KINDS:
            found.append(Token(_KINDS[name], text[start:end], start, end, line, start - begin + 1))
        newlines = text.count("\n", start, end)
        if newlines:
            line, begin = line + newlines, text.rindex("\n", start, end) + 1
    return tuple(found)


def comments(text: str) -> Iterator[str]:
    """All comments of a text that end with their line, without the leading ``%``."""
    for match in _scan(text):
        if match[0] == "LINE_COMMENT":
            yield text[match[1] + 1 : match[2]]


def statements(all_tokens: Sequence[Token]) -> Iterator[Tuple[int, int]]:
    """Index ranges ``(first, after)`` of the statements; each holds its dot, unless the text ends before."""
    first = 0
    while all_tokens[first].kind is not Kind.END:
        after = _after_dot(all_tokens, first)
        yield first, after
        first = after


def _after_dot(all_tokens: Sequence[Token], first: int) -> int:
    """Return the index after a statement and the weight or value that some have behind their dot."""
    if all_tokens[first].kind is Kind.SCRIPT:
        return first + 1
    index, theory = first, all_tokens[first].text == "#theory"
    while all_tokens[index].kind is not Kind.END:
        if all_tokens[index].text == "." and (not theory or all_tokens[index - 1].text == "}"):
            return _after_weight(all_tokens, all_tokens[first].text, index + 1)
        index += 1
    return index


def _after_weight(all_tokens: Sequence[Token], word: str, index: int) -> int:
    """Return the index after ``[...]``, or ``<...>`` of gringo 3's weak constraints, if it belongs to the dot."""
    closing = {"[": "]", "<": ">"}.get(all_tokens[index].text, "")
    if not closing or word not in _WEIGHTED or (closing == ">" and word != ":~"):
        return index
    end = index
    while all_tokens[end].text not in (closing, ".") and all_tokens[end].kind is not Kind.END:
        end += 1
    if closing == "]" and all_tokens[end].text == "]" and _is_head(all_tokens, index + 1, end):
        return index
    return min(end + 1, len(all_tokens) - 1)


_WEIGHTED = (":~", "#external", "#heuristic")
"""Statements that can have brackets behind their dot."""

_NO_WEIGHT = ("=", ":", "not", "{", "<", "<=", ">", ">=", "==", "!=")
"""Tokens of gringo 3's weighted literals that no weight behind a dot has."""

_BEHIND_HEAD = (".", ":-", "<", "<=", ">", ">=", "==")


def _is_head(all_tokens: Sequence[Token], first: int, closing: int) -> bool:
    """Tell whether brackets begin a statement of gringo 3: they hold no weight, or the statement goes on."""
    behind = all_tokens[closing + 1 : closing + 3]
    bound = len(behind) > 1 and behind[0].kind is Kind.NUMBER and behind[1].text in (".", ":-")
    inside = (token.text for token in all_tokens[first:closing])
    return bound or behind[0].text in _BEHIND_HEAD or any(text in _NO_WEIGHT for text in inside)


@lru_cache(maxsize=32)
def _scan(text: str) -> Tuple[Tuple[str, int, int], ...]:
    """Return what a text is made of, with the space and the comments, in order."""
    return tuple(_pieces(text))


def _pieces(text: str) -> Iterator[Tuple[str, int, int]]:
    offset = 0
    while offset < len(text):
        match = _TOKEN.match(text, offset)
        name, end = (str(match.lastgroup), match.end()) if match else ("UNKNOWN", offset + 1)
        if name == "BLOCK_COMMENT":
            end = _end_of_comment(text, end)
            name = "BLOCK_COMMENT" if end > 0 else "UNKNOWN"
            end = end if end > 0 else len(text)
        yield name, offset, end
        offset = end


def _end_of_comment(text: str, offset: int) -> int:
    """The end of a block comment that began before the offset, or -1; a ``%`` inside hides the rest of its line."""
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
    """A program cannot be translated faithfully; :attr:`faults` lists every place and reason."""
