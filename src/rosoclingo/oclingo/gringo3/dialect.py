"""Tells gringo 3's language from clingo 5's by the tokens and shapes that only one of them has.

Each statement is looked at by itself: it may hold *evidence* for one of the languages, it may read differently in both
(a *conflict*), or mean the same in both. What a conflict means is decided by the rest of its file, see :func:`decide`.
"""

import enum
import re
from dataclasses import dataclass, field
from typing import Iterable, Iterator, List, Optional, Sequence, Tuple

from rosoclingo.oclingo.gringo3.lexer import Kind, Token, comments, statements


class Sign(enum.Enum):
    """What a finding says about the language."""

    GRINGO3 = "only in gringo 3"
    CLINGO5 = "only in clingo 5"
    CONFLICT = "different meanings"
    QUIET = "different meanings, but no cause for a warning"


@dataclass(frozen=True)
class Finding:
    """One thing that was found: what it says, where, and what it is."""

    sign: Sign
    token: Token
    what: str


_ONLY_GRINGO3 = ("#hide", "#domain", "#compute", "#avg", "#even", "#odd", "#mod", "#div", "#pow", "#abs", ":=", ";;")
_ONLY_CLINGO5 = ("#heuristic", "#edge", "#project", "#theory", "#defined", "#inf", "#sup", "$")
_WORDS = {**dict.fromkeys(_ONLY_GRINGO3, Sign.GRINGO3), **dict.fromkeys(_ONLY_CLINGO5, Sign.CLINGO5)}
_COMPARISONS = ("=", "==", "!=", "<", "<=", ">", ">=")
_OPTIMIZE = ("#minimize", "#minimise", "#maximize", "#maximise")
_TUPLE_FUNCTIONS = ("#sum", "#sum+", "#min", "#max")
_OPENING = {"(": ")", "{": "}", "[": "]"}
_FUNCTIONS = ("#count", *_TUPLE_FUNCTIONS, "#avg", "#even", "#odd")
_BEFORE_AGGREGATE = ("", ":-", ":~", ",", ";", "not", ":")
_AFTER_AGGREGATE = ("", ".", ":-", ",", ";", ":")
_TUPLE_STARTS = (Kind.VARIABLE, Kind.NUMBER, Kind.STRING, Kind.BASED_NUMBER, Kind.ANONYMOUS)


@dataclass
class _Group:
    """What was seen since a bracket was opened, or, at the bottom, since the statement began."""

    bracket: str
    opening: Token
    name: str = ""
    first_in_segment: bool = True
    colons: int = 0
    commas: int = 0
    semicolons: int = 0
    comparisons: int = 0
    comma: Optional[Token] = None  # the first one between elements in braces


def findings(statement: Sequence[Token]) -> Iterator[Finding]:
    """All findings of a statement, in no particular order."""
    scanner = _Scanner(statement)
    yield from scanner.words()
    yield from scanner.neighbours()
    yield from scanner.bounds()
    yield from scanner.shapes()


class _Scanner:
    def __init__(self, statement: Sequence[Token]) -> None:
        self._tokens = statement
        self._name = statement[0].text if statement[0].kind is Kind.DIRECTIVE else ""
        self._in_body = False
        self._conditional = False
        self._several: Optional[Token] = None
        self._groups = [_Group("", statement[0])]

    def words(self) -> Iterator[Finding]:
        """Tokens that only one language has."""
        for token in self._tokens:
            if token.kind in (Kind.DIRECTIVE, Kind.SYMBOL) and token.text in _WORDS:
                yield Finding(_WORDS[token.text], token, f"'{token.text}'")
            elif token.kind is Kind.BASED_NUMBER:
                yield Finding(Sign.CLINGO5, token, "a number with a base")
            elif token.kind is Kind.SCRIPT:
                old = token.text.startswith("#begin_lua")
                yield Finding(Sign.GRINGO3 if old else Sign.CLINGO5, token, "a script")

    def neighbours(self) -> Iterator[Finding]:
        """Pairs of tokens that only one language has."""
        for before, token in zip((None, *self._tokens), self._tokens):
            left = "" if before is None else before.text
            if left == "not" and token.text == "not":
                yield Finding(Sign.CLINGO5, token, "double negation")
            elif token.text in ("..", ";") and self._name == "#const":
                yield Finding(Sign.GRINGO3, token, "a constant of a pool or a range")
            elif token.text == "&" and left in ("", ":-", ",", ";", "not"):
                yield Finding(Sign.CLINGO5, token, "a theory atom")
            elif token.text == "<" and left in ("{", ",") and self._name != "#theory":
                yield Finding(Sign.GRINGO3, token, "a tuple in '<>'")
        if self._tokens[0].text == ":~" and self._tokens[-1].text in ("]", ">"):
            new = self._tokens[-1].text == "]"
            yield Finding(Sign.CLINGO5 if new else Sign.GRINGO3, self._tokens[0], "a weak constraint")
        yield from self._display()

    def bounds(self) -> Iterator[Finding]:
        """Yield comparisons next to aggregates that only clingo 5 has."""
        depth = opening = 0
        for index, token in enumerate(self._tokens):
            if token.kind is Kind.STRING:
                continue
            if token.text in _OPENING:
                opening = index if not depth else opening
                depth += 1
            elif token.text in _OPENING.values():
                depth -= 1
                if depth == 0 and token.text in "}]" and self._is_new(*self._around(opening, index)):
                    yield Finding(Sign.CLINGO5, token, "a comparison next to an aggregate")

    def _around(self, opening: int, closing: int) -> Tuple[int, int]:
        """The indices of the tokens before and after an aggregate, -1 for none."""
        named = opening > 0 and self._tokens[opening - 1].text in _FUNCTIONS
        return opening - 1 - named, closing + 1 if closing + 1 < len(self._tokens) else -1

    def _is_new(self, left: int, right: int) -> bool:
        """Tell whether gringo 3 lacks these bounds: it has ``<`` and the like twice, or ``==``, ``=`` once."""
        before, after = ("" if index < 0 else self._tokens[index].text for index in (left, right))
        if before not in _COMPARISONS and after not in _COMPARISONS:
            return False
        if after not in _COMPARISONS:
            variable = left > 0 and self._tokens[left - 1].kind is Kind.VARIABLE
            return before == "!=" or (before == "=" and not variable) or after not in _AFTER_AGGREGATE
        if before in _COMPARISONS:
            return not any(before in same and after in same for same in (("<", "<="), (">", ">=")))
        return after in ("=", "!=") or before not in _BEFORE_AGGREGATE

    def _display(self) -> Iterator[Finding]:
        if self._name == "#show" and len(self._tokens) > 1:
            tuple_like = self._tokens[1].kind in _TUPLE_STARTS or self._tokens[1].text == "("
            sign = Sign.CLINGO5 if tuple_like else Sign.QUIET
            yield Finding(sign, self._tokens[0], "#show")
        elif self._name in _OPTIMIZE:
            yield Finding(Sign.QUIET, self._tokens[0], "an optimization statement")

    def shapes(self) -> Iterator[Finding]:
        """What separators and brackets tell."""
        for index, token in enumerate(self._tokens):
            group = self._groups[-1]
            if token.kind is Kind.STRING:
                group.first_in_segment = False
            elif token.text in _OPENING:
                yield from self._open(index, token)
            elif token.text in _OPENING.values():
                yield from self._close()
            else:
                yield from self._mark(group, token)
        if self._conditional and self._several and not self._name:
            yield Finding(Sign.CONFLICT, self._several, "an interval or a pool under a condition or in a disjunction")

    def _open(self, index: int, token: Token) -> Iterator[Finding]:
        self._groups[-1].first_in_segment = False
        if token.text != "(":
            self._groups[-1].comparisons = 0  # comparisons on both sides of an aggregate are no chain
        name = self._tokens[index - 1].text if index else ""
        self._groups.append(_Group(token.text, token, name if name.startswith("#") else ""))
        if token.text == "[":
            after_dot = index and self._tokens[index - 1].text == "."
            yield Finding(Sign.CLINGO5 if after_dot else Sign.GRINGO3, token, "square brackets")
        elif token.text == "{" and name in _TUPLE_FUNCTIONS:
            yield Finding(Sign.CLINGO5, token, f"'{name}' with braces")

    def _close(self) -> Iterator[Finding]:
        if len(self._groups) > 1:
            group = self._groups.pop()
            if group.bracket == "(" and group.semicolons and self._pool_differs(group):
                yield Finding(Sign.CONFLICT, group.opening, "a pool")
            elif group.comma is not None and not group.semicolons:  # both is a slip in either language
                yield Finding(Sign.GRINGO3, group.comma, "',' between elements")

    def _pool_differs(self, group: _Group) -> bool:
        """A pool reads alike in a plain head and in ``#external`` if it is the only argument."""
        inside = any(outer.bracket == "{" or outer.colons for outer in self._groups)
        return bool(group.commas) or inside or self._in_body

    def _mark(self, group: _Group, token: Token) -> Iterator[Finding]:
        if group.bracket in ("", "{"):
            yield from self._separator(group, token)
        elif token.text == ",":
            group.commas += 1
        elif token.text in ("..", ";"):
            self._several = token
            group.semicolons += token.text == ";"

    def _separator(self, group: _Group, token: Token) -> Iterator[Finding]:
        text = token.text
        if text == ":":
            yield from self._colon(group, token)
        elif text == ",":
            yield from self._comma(group, token)
        elif text == ";":
            yield Finding(Sign.CLINGO5, token, "';' between elements")
            group.semicolons += bool(group.bracket)
            group.first_in_segment, group.colons, group.comparisons = True, 0, 0
        elif text in ("|", ":-"):
            self._head_mark(group, text)
        elif text in _COMPARISONS:
            group.comparisons += 1
            if group.comparisons > 1:
                yield Finding(Sign.CLINGO5, token, "a chain of comparisons")
        if text not in (",", ";"):
            yield from self._start(group, token)

    def _head_mark(self, group: _Group, text: str) -> None:
        if text == ":-":
            self._in_body, group.colons, group.comparisons = True, 0, 0
        elif not self._in_body and not group.bracket:
            self._conditional, group.colons = True, 0

    def _start(self, group: _Group, token: Token) -> Iterator[Finding]:
        """The first token of an element: today's tuples may begin with what no literal begins with."""
        tuples = group.bracket == "{" and group.name in ("#count", *_OPTIMIZE)
        if tuples and group.first_in_segment:
            if token.kind in _TUPLE_STARTS:
                yield Finding(Sign.CLINGO5, token, "a tuple as element")
            elif token.text == "not":
                yield Finding(Sign.GRINGO3, token, f"a literal as element of '{group.name}'")
            else:
                yield Finding(Sign.CONFLICT, token, f"an element of '{group.name}'")
        group.first_in_segment = False

    def _colon(self, group: _Group, token: Token) -> Iterator[Finding]:
        group.colons += 1
        group.comparisons = 0
        self._conditional = self._conditional or not group.bracket
        if group.colons > 1 and self._name not in ("#volatile", "#forget"):
            yield Finding(Sign.GRINGO3, token, "a second ':'")

    def _comma(self, group: _Group, token: Token) -> Iterator[Finding]:
        group.comparisons = 0
        if group.colons and self._name in ("#show", "#external"):
            yield Finding(Sign.CLINGO5, token, "',' in the condition of a directive")
        elif group.colons:
            yield Finding(Sign.CONFLICT, token, "',' after a condition")
        elif group.bracket == "{" and not group.name:
            group.comma = group.comma or token


_PRAGMA = re.compile(r"\s*dialect\s*:\s*(gringo|clingo)\s*([35])\s*$")
_STEP_DIRECTIVES = {"#base", "#cumulative", "#volatile", "#iinit", "#forget"}


class Dialect(enum.Enum):
    """The language of a statement or of a file."""

    GRINGO3 = "gringo 3"
    CLINGO5 = "clingo 5"
    EITHER = "either"
    CONFLICT = "conflict"


@dataclass(frozen=True)
class StatementDialect:
    """A statement's tokens as an index range, its language, and what tells it."""

    first: int
    after: int
    dialect: Dialect
    findings: Sequence[Finding] = ()


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
    """The language of each file of a program, and whether anything told it.

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
    found = list(findings(tokens[first:after]))
    return StatementDialect(first, after, _dialect(found), found)


def _dialect(found: Iterable[Finding]) -> Dialect:
    signs = {finding.sign for finding in found}
    if Sign.GRINGO3 in signs:
        return Dialect.GRINGO3
    if Sign.CLINGO5 in signs:
        return Dialect.CLINGO5
    return Dialect.CONFLICT if signs else Dialect.EITHER
