"""Tells gringo 3's language from clingo 5's by the tokens and shapes that only one of them has.

Each statement is looked at by itself: it may hold *evidence* for one of the languages, it may read differently in both
(a *conflict*), or mean the same in both. What a conflict means is decided by the rest of its file, see :func:`decide`.
"""

import enum
import re
from dataclasses import dataclass, field
from typing import Iterable, List, Optional, Sequence, Tuple

from rosoclingo.oclingo.gringo3.evidence import Finding, Sign, findings
from rosoclingo.oclingo.gringo3.lexer import Token, comments, statements

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
