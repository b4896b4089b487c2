"""Which language a file is in, as far as that shows without gringo 3's grammar.

clingo's own parser says which statements it does not accept. The rest of the decision needs the grammar of gringo 3:
see :mod:`~rosoclingo.oclingo.gringo3.evidence`.
"""

import enum
import re
from functools import cached_property
from typing import Optional, Sequence, Set

from clingo.ast import parse_string

from rosoclingo.oclingo.gringo3.lexer import SourceToken, comments, statements, tokens

GRINGO3_WORDS = frozenset(
    ["#hide", "#domain", "#compute", "#avg", "#even", "#odd", "#mod", "#div", "#pow", "#abs", ":=", ";;"]
)
"""Tokens that only gringo 3 has, or reads in its own way."""

_AMBIGUOUS = frozenset([";", "|", "#show", "#minimize", "#maximize", "#minimise", "#maximise", "#count"])
"""Tokens that both languages have, at times with different meanings."""

STEP_DIRECTIVES = ("#base", "#cumulative", "#volatile", "#iinit", "#forget")
"""oClingo's directives, which clingo does not know."""

_PRAGMA = re.compile(r"\s*dialect\s*:\s*(gringo|clingo)\s*([35])\s*$")


class Dialect(enum.Enum):
    """The language of a file; a file that means the same in both is in either."""

    GRINGO3 = "gringo 3"
    CLINGO5 = "clingo 5"
    EITHER = "either"


class SourceFile:
    """A file of a program: its tokens and statements.

    Attributes:
        name: the name that messages give to the file.
        text: the text.
        tokens: the tokens of the text.
        ranges: the statements, as ranges of tokens.

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
        """The language that a comment ``% dialect: gringo 3`` names; the last one counts."""
        found = ["".join(match.groups()) for match in map(_PRAGMA.match, comments(self.text)) if match]
        names = {"gringo3": Dialect.GRINGO3, "clingo5": Dialect.CLINGO5}
        return names.get(found[-1]) if found else None

    @cached_property
    def by_directives(self) -> Optional[Dialect]:
        """The language for which the file's directives speak: oClingo's own ones, or ``#program``."""
        names = {self.tokens[first].text for first, _ in self.ranges}
        if names.isdisjoint(STEP_DIRECTIVES) == ("#program" not in names):
            return None
        return Dialect.CLINGO5 if "#program" in names else Dialect.GRINGO3

    @cached_property
    def not_clingo5(self) -> Set[int]:
        """The numbers of the statements that clingo 5 does not accept."""
        texts = [self._shown_to_clingo(self.statement(number)) for number in range(len(self.ranges))]
        if accepted_by_clingo("\n".join(texts)):
            return set()
        return {number for number, text in enumerate(texts) if not accepted_by_clingo(text)}

    @cached_property
    def has_gringo3_words(self) -> bool:
        """Whether the file has tokens that only gringo 3 has."""
        return any(one.text in GRINGO3_WORDS for one in self.tokens)

    @property
    def is_plain(self) -> bool:
        """Whether no statement of the file speaks for gringo 3."""
        plain = self.pragma is None and not self.has_gringo3_words and not self.not_clingo5
        return plain or self.pragma is Dialect.CLINGO5

    @cached_property
    def reads_alike(self) -> bool:
        """Whether no statement of a plain file has anything that the languages may read differently."""
        for first, after in self.ranges:
            words = [one.text for one in self.tokens[first:after]]
            behind = words[words.index(":") :] if ":" in words else []
            if words[0] not in STEP_DIRECTIVES and (
                not _AMBIGUOUS.isdisjoint(words) or behind.count(":") > 1 or "," in behind or (behind and ".." in words)
            ):
                return False
        return True

    def _shown_to_clingo(self, statement: Sequence[SourceToken]) -> str:
        """Return the text of a statement; "" for directives that clingo does not know, or that name other files."""
        words = [one.text for one in statement]
        if words[0] in (*STEP_DIRECTIVES, "#include") or is_signature(statement):
            return ""
        return self.text[statement[0].start : statement[-1].end]


def is_signature(statement: Sequence[SourceToken]) -> bool:
    """Return whether a statement is ``#external p/n.``"""
    words = [one.text for one in statement]
    return words[0] == "#external" and len(words) in (5, 6) and words[-3] == "/" and words[-1] == "."


def accepted_by_clingo(text: str) -> bool:
    """Return whether clingo's parser accepts a text.

    Only ASCII goes to clingo: its Python module ends the process when a message cuts another character in two.
    """
    try:
        plain = text.encode("ascii", "replace").decode("ascii")
        parse_string(plain, lambda node: None, logger=lambda code, message: None)
    except RuntimeError:
        return False
    return True
