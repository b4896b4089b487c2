"""Detection of a file's language, as far as possible without the grammar of gringo 3.

clingo's parser shows which statements clingo does not accept. The remaining decisions need the grammar of gringo 3; see
:mod:`~rosoclingo.oclingo.gringo3.evidence`.
"""

import enum
import re
from functools import cached_property
from typing import Callable, List, Optional, Sequence, Set

from clingo.ast import AST, parse_string

from rosoclingo.oclingo.gringo3.lexer import SourceToken, TokenKind, comments, statements, tokens

GRINGO3_WORDS = frozenset(
    ["#hide", "#domain", "#compute", "#avg", "#even", "#odd", "#mod", "#div", "#pow", "#abs", ":=", ";;"]
)
"""Tokens that only gringo 3 has, or that it reads differently."""

_AMBIGUOUS = frozenset([";", "|", "#show", "#minimize", "#maximize", "#minimise", "#maximise", "#count"])
"""Tokens of both languages whose meanings can differ."""

STEP_DIRECTIVES = ("#base", "#cumulative", "#volatile", "#iinit", "#forget")
"""oClingo's directives, which clingo does not know."""

_PRAGMA = re.compile(r"\s*dialect\s*:\s*(gringo|clingo)\s*([35])\s*$")


class Dialect(enum.Enum):
    """The language of a file; ``EITHER`` if it means the same in both."""

    GRINGO3 = "gringo 3"
    CLINGO5 = "clingo 5"
    EITHER = "either"


class SourceFile:
    """A file of a program: its tokens and statements.

    Attributes:
        name: the file's name in messages.
        text: the text.
        tokens: the tokens of the text.
        ranges: the statements, as token ranges ``(first, after)``.

    """

    def __init__(self, name: str, text: str) -> None:
        self.name, self.text = name, text
        self.tokens = tokens(text)
        self.ranges = list(statements(self.tokens))

    def statement(self, number: int) -> Sequence[SourceToken]:
        """Return the tokens of a statement."""
        return self.tokens[slice(*self.ranges[number])]

    @cached_property
    def pragma(self) -> Optional[Dialect]:
        """The language in the last comment such as ``% dialect: gringo 3``."""
        found = ["".join(match.groups()) for match in map(_PRAGMA.match, comments(self.text)) if match]
        names = {"gringo3": Dialect.GRINGO3, "clingo5": Dialect.CLINGO5}
        return names.get(found[-1]) if found else None

    @cached_property
    def by_directives(self) -> Optional[Dialect]:
        """The language that the file's directives indicate: oClingo's own directives, or ``#program``."""
        names = {self.tokens[first].text for first, _ in self.ranges}
        if names.isdisjoint(STEP_DIRECTIVES) == ("#program" not in names):
            return None
        return Dialect.CLINGO5 if "#program" in names else Dialect.GRINGO3

    @cached_property
    def not_clingo5(self) -> Set[int]:
        """The numbers of the statements that clingo 5 does not accept."""
        texts: List[str] = []
        for number in range(len(self.ranges)):
            statement = self.statement(number)
            is_known = statement[0].text not in (*STEP_DIRECTIVES, "#include") and not is_signature(statement)
            texts.append(self.text[statement[0].start : statement[-1].end] if is_known else "")
        if accepted_by_clingo("\n".join(texts)):
            return set()
        return {number for number, text in enumerate(texts) if not accepted_by_clingo(text)}

    @property
    def is_plain(self) -> bool:
        """Whether no statement of the file indicates gringo 3."""
        if self.pragma is not None:
            return self.pragma is Dialect.CLINGO5
        return GRINGO3_WORDS.isdisjoint(one.text for one in self.tokens) and not self.not_clingo5

    @cached_property
    def reads_alike(self) -> bool:
        """Whether no statement of a plain file contains syntax that the languages can read differently."""
        for first, after in self.ranges:
            words = [one.text for one in self.tokens[first:after]]
            behind = words[words.index(":") :] if ":" in words else []
            if words[0] not in STEP_DIRECTIVES and (
                not _AMBIGUOUS.isdisjoint(words) or behind.count(":") > 1 or "," in behind or (behind and ".." in words)
            ):
                return False
        return True


def is_signature(statement: Sequence[SourceToken]) -> bool:
    """Return whether a statement is ``#external p/n.``"""
    if statement[0].text != "#external" or len(statement) not in (5, 6):
        return False
    name, slash, arity, dot = statement[-4:]
    parts = name.kind is TokenKind.IDENTIFIER and arity.kind is TokenKind.NUMBER
    return parts and (slash.text, dot.text) == ("/", ".") and statement[-5].text in ("#external", "-")


def accepted_by_clingo(text: str, found: Callable[[AST], None] = lambda statement: None) -> bool:
    """Return whether clingo's parser accepts a text; ``found`` gets the statements up to the first error.

    The text is converted to ASCII: clingo's module aborts the process if a message cuts a longer character.
    """
    try:
        plain = text.encode("ascii", "replace").decode("ascii")
        parse_string(plain, found, logger=lambda code, message: None)
    except RuntimeError:
        return False
    return True
