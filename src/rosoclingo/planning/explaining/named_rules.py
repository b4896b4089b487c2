"""Rules of a program as they are told of: where they stand, their text, and what their author says of them.

An author's words for a rule stand above it in a comment that begins with ``%!``; names of variables in braces stand for
their values:

    %! nobody drives from {A} to {B}, which is blocked
    :- blocked(A,B), at(A,t-1), move(B,t).
"""

import re
from dataclasses import dataclass
from enum import Enum
from typing import Dict, Iterable, List, Mapping, Tuple

from clingo.ast import Location

from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.sources import Source

_WORDS = re.compile(r"\s*%!\s*(?P<words>\S.*?)\s*$")
_COMMENT = re.compile(r'("(?:[^"\\]|\\.)*")|%.*')
_PLACE = re.compile(r"\{(?P<name>_*[A-Z]\w*'*)\}")


class RuleKind(Enum):
    """What sort of rule may forbid a plan."""

    VOLATILE = "volatile constraint"
    INTEGRITY = "integrity constraint"
    BOUND = "bound of a choice"
    FACT = "fact"


@dataclass(frozen=True)
class NamedRule:
    """A rule of a program that can be let go.

    Attributes:
        number: what it is known by in its program, from 0.
        kind: what it is.
        file, line, column: where it begins, from 1.
        text: the rule as it is written, as far to the left as can be; of facts written as one this one.
        words: what its author says of it, empty where nothing.
        variables: the names of what its instances differ in, sorted.

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

    def saying(self, values: Mapping[str, str]) -> str:
        """Return its words with the values of variables; those without one keep their names."""
        return _PLACE.sub(lambda found: values.get(found["name"], found["name"]), self.words)


class RuleTexts:
    """The texts of a program's rules, as they were written."""

    def __init__(self, sources: Iterable[Source]) -> None:
        self._lines: Dict[str, List[str]] = {one.name: one.text.splitlines() for one in sources}

    def text(self, statement: Node) -> str:
        """Return the text of a statement; where its columns tell nothing, the lines in which it stands."""
        location = statement.location
        lines = self._lines.get(location.begin.filename, [])[location.begin.line - 1 : location.end.line]
        text = _laid_out(_cut(lines, location), location.begin.column - 1)
        return text if text.endswith(".") else _laid_out(lines, 0) or str(statement)

    def words(self, statement: Node) -> str:
        """Return what the comment right above a statement says, of one line or several."""
        begin = statement.location.begin
        found: List[str] = []
        for line in reversed(self._lines.get(begin.filename, [])[: begin.line - 1]):
            comment = _WORDS.match(line)
            if comment is None:
                break
            found.insert(0, comment["words"])
        return " ".join(found)


def _cut(lines: List[str], location: Location) -> List[str]:
    """Return the part of the lines that a location holds, whose columns count bytes of UTF-8."""
    pieces = [line.encode() for line in lines]
    if pieces:
        pieces[-1] = pieces[-1][: location.end.column - 1]
        pieces[0] = pieces[0][location.begin.column - 1 :]
    return [piece.decode(errors="replace") for piece in pieces]


def _laid_out(lines: Iterable[str], indent: int) -> str:
    """Return lines without comments, those after the first one less an indent of so many columns."""
    bare = [_COMMENT.sub(lambda found: found[1] or "", line).rstrip() for line in lines]
    first, *rest = [line for line in bare if line] or [""]
    return "\n".join([first.strip(), *(line[min(indent, len(line) - len(line.lstrip())) :] for line in rest)])
