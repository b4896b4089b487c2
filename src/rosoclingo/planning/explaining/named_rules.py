"""The rules of a program in explanations: place, text and the author's comment.

The author's comment precedes the rule and begins with ``%!``; variables in braces are replaced by their values:

    %! nobody drives from {A} to {B}, which is blocked
    :- blocked(A,B), at(A,t-1), move(B,t).
"""

import re
from dataclasses import dataclass
from enum import Enum
from typing import Dict, Iterable, List, Mapping, Tuple

from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.sources import Source

_WORDS = re.compile(r"\s*%!\s*(?P<words>\S.*?)\s*$")
_COMMENT = re.compile(r'("(?:[^"\\]|\\.)*")|%.*')
_PLACE = re.compile(r"\{(?P<name>_*[A-Z]\w*'*)\}")


class RuleKind(Enum):
    """Kinds of rules and facts in explanations."""

    VOLATILE = "volatile constraint"
    INTEGRITY = "integrity constraint"
    BOUND = "bound of a choice"
    FACT = "fact"


@dataclass(frozen=True)
class NamedRule:
    """A rule or fact of a program that can be relaxed.

    Attributes:
        number: its index in the program, from 0.
        kind: its kind.
        file, line, column: its place; lines and columns count from 1.
        text: its text without indentation; for a pool, only this fact.
        words: the author's comment, empty if there is none.
        variables: the names of its global variables, sorted.

    """

    number: int
    kind: RuleKind
    file: str
    line: int
    column: int
    text: str
    words: str = ""
    variables: Tuple[str, ...] = ()

    @property
    def place(self) -> str:
        """File, line and column."""
        return f"{self.file}:{self.line}:{self.column}"

    def comment(self, values: Mapping[str, str]) -> str:
        """Return the author's comment with the values of variables; variables without a value keep their names."""
        return _PLACE.sub(lambda found: values.get(found["name"], found["name"]), self.words)


class RuleTexts:
    """The source texts of a program's rules."""

    def __init__(self, sources: Iterable[Source]) -> None:
        self._lines: Dict[str, List[str]] = {one.name: one.text.splitlines() for one in sources}

    def text(self, statement: Node) -> str:
        """Return the text of a statement; whole lines if its location has no usable columns."""
        location = statement.location
        lines = self._lines.get(location.begin.filename, [])[location.begin.line - 1 : location.end.line]
        pieces = [line.encode() for line in lines]  # columns count bytes
        if pieces:
            pieces[-1] = pieces[-1][: location.end.column - 1]
            pieces[0] = pieces[0][location.begin.column - 1 :]
        text = _laid_out((piece.decode(errors="replace") for piece in pieces), location.begin.column - 1)
        return text if text.endswith(".") else _laid_out(lines, 0) or str(statement)

    def words(self, statement: Node) -> str:
        """Return the author's comment above a statement as one line."""
        begin = statement.location.begin
        found: List[str] = []
        for line in reversed(self._lines.get(begin.filename, [])[: begin.line - 1]):
            comment = _WORDS.match(line)
            if comment is None:
                break
            found.insert(0, comment["words"])
        return " ".join(found)


def _laid_out(lines: Iterable[str], indent: int) -> str:
    """Strip comments, and at most ``indent`` columns from each line after the first."""
    bare = [_COMMENT.sub(lambda found: found[1] or "", line).rstrip() for line in lines]
    first, *rest = [line for line in bare if line] or [""]
    return "\n".join([first.strip(), *(line[min(indent, len(line) - len(line.lstrip())) :] for line in rest)])
