"""Punctuation slips that change the meaning of a statement: ',' for '.', ':' for ':-', '.' for ','."""

from typing import Iterable, Iterator, List, Sequence, Tuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.gringo3.lexer import SourceToken, TokenKind, statements, tokens

KIND = "mark"

_DEPTH = {"(": 1, "{": 1, "[": 1, ")": -1, "}": -1, "]": -1}


def suspicious_marks(texts: Iterable[Tuple[str, str]]) -> Iterator[Fault]:
    """Yield the statements that a wrong mark probably changes; ``texts`` are names and texts of clingo files."""
    for name, text in texts:
        found = tokens(text)
        follows_body = False
        for first, after in statements(found):
            if found[first].kind not in (TokenKind.DIRECTIVE, TokenKind.SCRIPT):
                marks, has_body = _marks(found[first:after])
                yield from _odd_heads(name, marks, has_body)
                if follows_body and not has_body and found[first].text == "not":
                    message = "the statement after this dot begins with not: it forbids its atoms at all times"
                    yield _mark_fault(name, found[first - 1], message, "did you mean a comma?")
                follows_body = has_body


def _odd_heads(name: str, marks: Sequence[SourceToken], has_body: bool) -> Iterator[Fault]:
    seen = [one.text for one in marks]
    if seen and seen[0] == "," and ":" not in seen:
        message = "a comma between heads makes a disjunction: only one of them has to hold"
        yield _mark_fault(name, marks[0], message, "did you mean a dot? for a disjunction write ';'")
    elif seen and seen[0] == ":" and not {";", "|"} & set(seen) and not has_body:
        message = "':' in a head makes a disjunction over the condition, not a rule"
        yield _mark_fault(name, marks[0], message, "did you mean ':-'?")


def _mark_fault(name: str, mark: SourceToken, message: str, remedy: str) -> Fault:
    return Fault(name, mark.line, mark.column, message, remedy, KIND)


def _marks(statement: Sequence[SourceToken]) -> Tuple[List[SourceToken], bool]:
    """Return the punctuation of a head outside brackets, in order, and whether the statement has a body."""
    depth, head = 0, []  # type: int, List[SourceToken]
    for one in statement:
        depth += _DEPTH.get(one.text, 0) if one.kind is TokenKind.SYMBOL else 0
        if not depth and one.text in (":-", ":~"):
            return head, True
        if not depth and one.kind is TokenKind.SYMBOL and one.text in (",", ":", ";", "|"):
            head.append(one)
    return head, False
