"""Marks that make another statement of what is written: ',' for '.', ':' for ':-', ';' for ':', '.' for ','."""

from typing import Iterable, Iterator, List, NamedTuple, Sequence, Tuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.gringo3.lexer import SourceToken, TokenKind, statements, tokens

KIND = "mark"

_DEPTH = {"(": 1, "{": 1, "[": 1, ")": -1, "}": -1, "]": -1}


class _Marks(NamedTuple):
    """The marks of a statement that stand in no bracket: those of its head in order, and whether it has a body."""

    head: List[SourceToken]
    has_body: bool


def odd_marks(texts: Iterable[Tuple[str, str]]) -> Iterator[Fault]:
    """Yield the statements of files, names and texts in clingo's language, that a wrong mark makes another one of."""
    for name, text in texts:
        found = tokens(text)
        before = _Marks([], False)
        for first, after in statements(found):
            if found[first].kind not in (TokenKind.DIRECTIVE, TokenKind.SCRIPT):
                marks = _marks(found[first:after])
                yield from _odd(name, marks)
                if before.has_body and not marks.has_body and found[first].text == "not":
                    message = "the statement behind this dot begins with not: it forbids what it names at all times"
                    yield _at(name, found[first - 1], message, "is a comma meant?")
                before = marks


def _odd(name: str, marks: _Marks) -> Iterator[Fault]:
    seen = [one.text for one in marks.head]
    if seen and seen[0] == "," and ":" not in seen:
        message = "a comma joins heads into one statement, which says that one of them holds and not which"
        yield _at(name, marks.head[0], message, "is a dot meant? where one of them may hold, write ';'")
    elif seen and seen[0] == ":" and not {";", "|"} & set(seen) and not marks.has_body:
        message = "':' in a head lets one of all for which the condition holds be true; no rule follows from it"
        yield _at(name, marks.head[0], message, "is ':-' meant?")


def _at(name: str, mark: SourceToken, message: str, mend: str) -> Fault:
    return Fault(name, mark.line, mark.column, message, mend, KIND)


def _marks(statement: Sequence[SourceToken]) -> _Marks:
    depth, head = 0, []  # type: int, List[SourceToken]
    for one in statement:
        depth += _DEPTH.get(one.text, 0) if one.kind is TokenKind.SYMBOL else 0
        if not depth and one.text in (":-", ":~"):
            return _Marks(head, True)
        if not depth and one.kind is TokenKind.SYMBOL and one.text in (",", ":", ";", "|"):
            head.append(one)
    return _Marks(head, False)
