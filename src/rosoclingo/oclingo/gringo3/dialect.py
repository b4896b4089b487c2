"""Tells gringo 3's language from clingo 5's by the tokens and shapes that only one of them has.

Each statement is looked at by itself: it may hold *evidence* for one of the languages, it may read differently in both
(a *conflict*), or mean the same in both. What a conflict means is decided by the rest of its file, see :func:`decide`.
"""

import enum
import re
from dataclasses import dataclass, field
from typing import Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from rosoclingo.oclingo.gringo3.lexer import Kind, Token, comments, statements

_ONLY_GRINGO3 = {"#hide", "#domain", "#compute", "#avg", "#even", "#odd", "#mod", "#div", "#pow", "#abs", ":=", ";;"}
_ONLY_CLINGO5 = {"#heuristic", "#edge", "#project", "#theory", "#defined", "#inf", "#sup", "$"}
_COMPARISONS = ("=", "==", "!=", "<", "<=", ">", ">=")
_OPTIMIZE = ("#minimize", "#minimise", "#maximize", "#maximise")
_TUPLE_FUNCTIONS = ("#sum", "#sum+", "#min", "#max")
_FUNCTIONS = ("#count", *_TUPLE_FUNCTIONS, "#avg", "#even", "#odd")
_BEFORE_AGGREGATE = ("", ":-", ":~", ",", ";", "not", ":")
_AFTER_AGGREGATE = ("", ".", ":-", ",", ";", ":")
_TUPLE_STARTS = (Kind.VARIABLE, Kind.NUMBER, Kind.BASED_NUMBER, Kind.ANONYMOUS)


_PRAGMA = re.compile(r"\s*dialect\s*:\s*(gringo|clingo)\s*([35])\s*$")
_STEP_DIRECTIVES = {"#base", "#cumulative", "#volatile", "#iinit", "#forget"}


class Dialect(enum.Enum):
    """The language of a statement or of a file."""

    GRINGO3 = "gringo 3"
    CLINGO5 = "clingo 5"
    EITHER = "either"
    CONFLICT = "conflict"


class Conflict(NamedTuple):
    """What reads differently in both languages, and where; "" where that is no cause for a warning."""

    token: Token
    what: str


@dataclass(frozen=True)
class StatementDialect:
    """A statement's tokens as an index range, its language, and where it reads differently in both."""

    first: int
    after: int
    dialect: Dialect
    conflicts: Sequence[Conflict] = ()


@dataclass
class FileDialect:
    """What the statements of a file tell about its language."""

    statements: List[StatementDialect] = field(default_factory=list)
    pragma: Optional[Dialect] = None
    by_directives: Optional[Dialect] = None

    def of(self, dialect: Dialect) -> List[StatementDialect]:
        """The statements of one kind."""
        return [statement for statement in self.statements if statement.dialect is dialect]

    @property
    def decided(self) -> Optional[Dialect]:
        """The language of the file as far as it tells itself; None if it holds conflicts and nothing to decide them."""
        if self.pragma:
            return self.pragma
        old, new = bool(self.of(Dialect.GRINGO3)), bool(self.of(Dialect.CLINGO5))
        if old != new:
            return Dialect.GRINGO3 if old else Dialect.CLINGO5
        if not old and not self.of(Dialect.CONFLICT):
            return Dialect.EITHER
        return self.by_directives


def inspect(text: str, tokens: Sequence[Token]) -> FileDialect:
    """What a file tells about its language."""
    found = FileDialect(pragma=_pragma(text))
    names = set()
    for first, after in statements(tokens):
        found.statements.append(_statement(tokens, first, after))
        names.add(tokens[first].text)
    if bool(names & _STEP_DIRECTIVES) != ("#program" in names):
        found.by_directives = Dialect.CLINGO5 if "#program" in names else Dialect.GRINGO3
    return found


def decide(files: Sequence[FileDialect], undecided: Dialect) -> List[Tuple[Dialect, bool]]:
    """Return the language of each file of a program, and whether there was evidence for it.

    A pragma ``% dialect: gringo 3`` decides; then evidence, if it is all for one language; then oClingo's directives
    against ``#program``. A file that reads differently in both languages and holds nothing of that follows the other
    files of the program if they agree, and is else taken for ``undecided``. Files that mean the same in both follow
    too, since declarations such as ``#domain`` reach from file to file.
    """
    own = [found.decided for found in files]
    known = {dialect for dialect in own if dialect in (Dialect.GRINGO3, Dialect.CLINGO5)}
    common = known.pop() if len(known) == 1 else None
    return [(_decision(dialect, common, undecided), bool(dialect or common)) for dialect in own]


def _decision(own: Optional[Dialect], common: Optional[Dialect], undecided: Dialect) -> Dialect:
    if own is None:
        return common or undecided
    if own is Dialect.EITHER:
        return common or Dialect.EITHER
    return own


def _pragma(text: str) -> Optional[Dialect]:
    for comment in comments(text):
        match = _PRAGMA.match(comment)
        if match:
            return {"gringo3": Dialect.GRINGO3, "clingo5": Dialect.CLINGO5}.get("".join(match.groups()))
    return None


def _statement(tokens: Sequence[Token], first: int, after: int) -> StatementDialect:
    shape = _Shape(tokens[first:after])
    if shape.is_gringo3():
        return StatementDialect(first, after, Dialect.GRINGO3)
    if shape.is_clingo5():
        return StatementDialect(first, after, Dialect.CLINGO5)
    conflicts = sorted(shape.conflicts(), key=lambda conflict: (not conflict.what, conflict.token.start))
    return StatementDialect(first, after, Dialect.CONFLICT if conflicts else Dialect.EITHER, conflicts)


class _Group(NamedTuple):
    """What stands in brackets of one kind, or outside of all: indices of the tokens, without those in inner brackets.

    ``opening`` is the index of the bracket, -1 outside of all; ``outer`` are the groups around it.
    """

    opening: int
    bracket: str
    name: str
    outer: "Tuple[_Group, ...]"
    inside: List[int]


class _Shape:
    """A statement's tokens, grouped by brackets."""

    def __init__(self, statement: Sequence[Token]) -> None:
        self._tokens = statement
        self._texts = ['""' if token.kind is Kind.STRING else token.text for token in statement]
        self._word = self._texts[0] if statement[0].kind is Kind.DIRECTIVE else ""
        self._groups = [_Group(-1, "", "", (), [])]
        self._close: Dict[int, int] = {}
        stack = self._groups[:]
        for index, text in enumerate(self._texts):
            stack[-1].inside.append(index)
            if text in ("(", "{", "["):
                before = self._text(index - 1)
                stack.append(_Group(index, text, before if before.startswith("#") else "", tuple(stack), []))
                self._groups.append(stack[-1])
            elif text in (")", "}", "]") and len(stack) > 1:
                stack[-1].inside.pop()
                self._close[stack.pop().opening] = index
        self._body = self._texts.index(":-") if ":-" in self._texts else len(self._texts)

    def _text(self, index: int) -> str:
        return self._texts[index] if 0 <= index < len(self._texts) else ""

    def _segments(self, group: _Group, *separators: str) -> Iterator[List[int]]:
        """Yield the indices in a group between separators, of which ``|`` is one in heads alone."""
        found: List[int] = []
        for index in group.inside:
            if self._texts[index] in separators and (self._texts[index] != "|" or index < self._body):
                yield found
                found = []
            else:
                found.append(index)
        yield found

    def _conditioned(self, group: _Group) -> Iterator[Tuple[int, List[int]]]:
        """Yield each colon outside of parentheses, with what follows it up to where the next literals begin."""
        head_marks = () if group.bracket else ("|", ":-")
        for segment in self._segments(group, ";", *head_marks) if group.bracket in ("", "{") else ():
            colons = [n for n, index in enumerate(segment) if self._texts[index] == ":"]
            if colons:
                yield segment[colons[0]], segment[colons[0] + 1 :]

    def _elements(self) -> Iterator[Tuple[_Group, int]]:
        """Yield the groups of ``#count`` and optimization, each with an index where an element begins."""
        for group in self._groups:
            if group.bracket == "{" and group.name in ("#count", *_OPTIMIZE):
                yield from ((group, segment[0]) for segment in self._segments(group, ";") if segment)

    def is_gringo3(self) -> bool:
        """Whether only gringo 3 has what is there."""
        texts, last = self._texts, self._tokens[-1].text
        pairs = list(zip(["", *texts], texts))
        return (
            not _ONLY_GRINGO3.isdisjoint(texts)
            or self._texts[0].startswith("#begin_lua")
            or (self._word == "#const" and (".." in texts or ";" in texts))
            or (self._word != "#theory" and any(after == "<" and before in ("{", ",") for before, after in pairs))
            or any(after == "[" and before != "." for before, after in pairs)
            or (texts[0] == ":~" and last == ">")
            or any(self._texts[index] == "not" for _, index in self._elements())
            or (self._word not in ("#volatile", "#forget") and self._has_second_colon())
            or any(map(self._is_old_set, self._groups))
        )

    def _has_second_colon(self) -> bool:
        return any(self._texts[index] == ":" for index in self._behind_colons())

    def _is_old_set(self, group: _Group) -> bool:
        """Whether there are commas between elements; where there are semicolons as well, it is a slip in either."""
        texts = [self._texts[index] for index in group.inside]
        before = texts[: texts.index(":")] if ":" in texts else texts
        closed = group.opening in self._close
        return group.bracket == "{" and not group.name and closed and "," in before and ";" not in texts

    def is_clingo5(self) -> bool:
        """Whether only clingo 5 has what is there."""
        texts, tokens = self._texts, self._tokens
        pairs = list(zip(["", *texts], texts))
        flat = (group for group in self._groups if group.bracket in ("", "{"))
        return (
            not _ONLY_CLINGO5.isdisjoint(texts)
            or any(token.kind in (Kind.BASED_NUMBER, Kind.SCRIPT) for token in tokens)
            or ("not", "not") in pairs
            or any(after == "&" and before in ("", ":-", ",", ";", "not") for before, after in pairs)
            or "[" in texts
            or (self._word == "#show" and any(one.kind in _SHOWN or one.text == "(" for one in tokens[1:2]))
            or any(self._texts[index] == ";" for group in flat for index in group.inside)
            or any(tokens[index].kind in _TUPLE_STARTS for _, index in self._elements())
            or any(group.bracket == "{" and group.name in _TUPLE_FUNCTIONS for group in self._groups)
            or (self._word in ("#show", "#external") and any(self._commas_behind()))
            or any(map(self._has_chain, self._groups))
            or any(map(self._has_new_bounds, self._groups[0].inside))
        )

    def _has_chain(self, group: _Group) -> bool:
        segments = self._segments(group, ",", ";", ":", ":-", "{", "}") if group.bracket in ("", "{") else iter(())
        return any(sum(self._texts[index] in _COMPARISONS for index in segment) > 1 for segment in segments)

    def _has_new_bounds(self, opening: int) -> bool:
        """Whether gringo 3 lacks the bounds of an aggregate: it has ``<`` and the like twice, or ``==``, ``=`` once."""
        if self._texts[opening] not in ("{", "[") or opening not in self._close:
            return False
        left = opening - 1 - (self._text(opening - 1) in _FUNCTIONS)
        before, after = self._text(left), self._text(self._close[opening] + 1)
        if before not in _COMPARISONS and after not in _COMPARISONS:
            return False
        if after not in _COMPARISONS:
            variable = left > 0 and self._tokens[left - 1].kind is Kind.VARIABLE
            return before == "!=" or (before == "=" and not variable) or after not in _AFTER_AGGREGATE
        if before in _COMPARISONS:
            return not any(before in same and after in same for same in (("<", "<="), (">", ">=")))
        return after in ("=", "!=") or before not in _BEFORE_AGGREGATE

    def _behind_colons(self) -> Iterator[int]:
        return (index for group in self._groups for _, rest in self._conditioned(group) for index in rest)

    def _commas_behind(self) -> Iterator[int]:
        """Yield the commas behind conditions."""
        return (index for index in self._behind_colons() if self._texts[index] == ",")

    def conflicts(self) -> Iterator[Conflict]:
        """Yield what reads differently in both languages."""
        if self._word in ("#show", *_OPTIMIZE):
            yield Conflict(self._tokens[0], "")
        for index in self._commas_behind():
            yield Conflict(self._tokens[index], "',' after a condition")
        for group, index in self._elements():
            if self._texts[index] not in ("(", '""', ","):
                yield Conflict(self._tokens[index], f"an element of '{group.name}'")
        pools = [group for group in self._groups if group.bracket == "(" and self._has(group, ";")]
        for group in pools:
            if self._has(group, ",") or group.opening > self._body or self._is_conditioned(group):
                yield Conflict(self._tokens[group.opening], "a pool")
        several = [
            i for group in self._groups if group.bracket == "(" for i in group.inside if self._texts[i] in ("..", ";")
        ]
        bottom = self._groups[0].inside
        conditional = any(self._texts[i] == ":" or (self._texts[i] == "|" and i < self._body) for i in bottom)
        if several and conditional and not self._word:
            what = "an interval or a pool under a condition or in a disjunction"
            yield Conflict(self._tokens[max(several)], what)

    def _has(self, group: _Group, text: str) -> bool:
        return any(self._texts[index] == text for index in group.inside)

    def _is_conditioned(self, group: _Group) -> bool:
        """Whether a group is in braces or behind a colon."""
        behind = (colon for outer in group.outer for colon, rest in self._conditioned(outer) if rest)
        in_braces = any(outer.bracket == "{" for outer in group.outer)
        return in_braces or any(colon < group.opening for colon in behind)


_SHOWN = (*_TUPLE_STARTS, Kind.STRING)
