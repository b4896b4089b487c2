"""Punctuation slips that change the meaning of a statement: ',' for '.', ':' for ':-', '.' for ','."""

from typing import Iterable, Iterator, List, NamedTuple, Sequence, Tuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.gringo3.lexer import SourceToken, TokenKind, statements, tokens

KIND = "mark"

_DEPTH = {"(": 1, "{": 1, "[": 1, ")": -1, "}": -1, "]": -1}


class _Marks(NamedTuple):
    """The punctuation of a head outside brackets, in order, and whether the statement has a body."""

    head: List[SourceToken]
    has_body: bool


def suspicious_marks(texts: Iterable[Tuple[str, str]]) -> Iterator[Fault]:
    """Yield the statements that a wrong mark probably changes; ``texts`` are names and texts of clingo files."""
    for name, text in texts:
        found = tokens(text)
        before = _Marks([], False)
        for first, after in statements(found):
            if found[first].kind not in (TokenKind.DIRECTIVE, TokenKind.SCRIPT):
                marks = _marks(found[first:after])
                yield from _odd_heads(name, marks)
                if before.has_body and not marks.has_body and found[first].text == "not":
                    message = "the statement after this dot begins with not: it forbids its atoms at all times"
                    yield _mark_fault(name, found[first - 1], message, "did you mean a comma?")
                before = marks


def _odd_heads(name: str, marks: _Marks) -> Iterator[Fault]:
    seen = [one.text for one in marks.head]
    if seen and seen[0] == "," and ":" not in seen:
        message = "a comma between heads makes a disjunction: only one of them has to hold"
        yield _mark_fault(name, marks.head[0], message, "did you mean a dot? for a disjunction write ';'")
    elif seen and seen[0] == ":" and not {";", "|"} & set(seen) and not marks.has_body:
        message = "':' in a head makes a disjunction over the condition, not a rule"
        yield _mark_fault(name, marks.head[0], message, "did you mean ':-'?")


def _mark_fault(name: str, mark: SourceToken, message: str, remedy: str) -> Fault:
    return Fault(name, mark.line, mark.column, message, remedy, KIND)


def _marks(statement: Sequence[SourceToken]) -> _Marks:
    depth, head = 0, []  # type: int, List[SourceToken]
    for one in statement:
        depth += _DEPTH.get(one.text, 0) if one.kind is TokenKind.SYMBOL else 0
        if not depth and one.text in (":-", ":~"):
            return _Marks(head, True)
        if not depth and one.kind is TokenKind.SYMBOL and one.text in (",", ":", ";", "|"):
            head.append(one)
    return _Marks(head, False)
