"""Tables of a run, which report their changes since a revision."""

import math
from typing import Any, Callable, Dict, Iterator, List, Optional, Sequence, Tuple

from rosoclingo.reasoning.keywords import name_of, shortened
from rosoclingo.runs.sentences import Sentences, actors_of
from rosoclingo.runs.topic_atoms import action_in

Record = Dict[str, Any]

#: Minimum distance and turn (m, rad) between two of the first recorded poses.
APART, TURNED = 0.05, 0.2

#: Number of recorded poses of a robot after which the distance between two of them doubles.
POSES = 5000


Point = Tuple[float, float]


def thinned(points: Sequence[Point], apart: float = 0.2) -> List[Point]:
    """Return the points of a path that are at least ``apart`` metres from the previous one, and its end."""
    kept: List[Point] = []
    for point in points:
        if not kept or math.dist(point, kept[-1]) >= apart:
            kept.append(point)
    return [*kept, *points[-1:]] if kept[-1:] != points[-1:] else kept


class Revision:
    """Counts changes."""

    def __init__(self) -> None:
        self.number = 0

    def next(self) -> int:
        """Return the number of the next change."""
        self.number += 1
        return self.number


class Table:
    """Records numbered from 0, which can be queried by their last change."""

    def __init__(self, revision: Revision) -> None:
        self._revision = revision
        self._records: List[Record] = []
        self._changed: Dict[int, int] = {}  # revision of the last change by number, the latest last

    def __len__(self) -> int:
        return len(self._records)

    def __iter__(self) -> Iterator[Record]:
        return iter(self._records)

    @property
    def last(self) -> Optional[Record]:
        """The newest record."""
        return self._records[-1] if self._records else None

    def add(self, **values: Any) -> int:
        """Add a record and return its number."""
        self._records.append(values)
        return self._touch(len(self._records) - 1)

    def change(self, number: int) -> Record:
        """Return a record to be changed, and mark it as changed."""
        return self._records[self._touch(number)]

    def __getitem__(self, number: int) -> Record:
        return self._records[number]

    def changes_since(self, revision: int) -> List[Tuple[int, Record]]:
        """Return the records that have changed since a revision, with their numbers."""
        found = []
        for number, changed in reversed(self._changed.items()):
            if changed <= revision:
                break
            found.append((number, self._records[number]))
        return sorted(found, key=lambda one: one[0])

    def _touch(self, number: int) -> int:
        self._changed.pop(number, None)
        self._changed[number] = self._revision.next()
        return number


class Words:
    """The distinct texts of a run, numbered from 0 in a table, so that other records refer to them by number.

    ``entry`` returns the record of a text.
    """

    def __init__(self, table: Table, entry: Callable[[str], Record]) -> None:
        self._table, self._entry = table, entry
        self._numbers: Dict[str, int] = {}

    def __getitem__(self, number: int) -> Record:
        return self._table[number]

    def __contains__(self, text: str) -> bool:
        return text in self._numbers

    def number(self, text: str) -> int:
        """Return the number of a text."""
        if text not in self._numbers:
            self._numbers[text] = self._table.add(**self._entry(text))
        return self._numbers[text]

    def numbers(self, texts: Sequence[str]) -> List[int]:
        """Return the numbers of texts."""
        return [self.number(text) for text in texts]


class PlannedActions(Words):
    """The distinct actions of plans as ``_action_lib`` atoms, each with its sentence."""

    def __init__(self, table: Table) -> None:
        super().__init__(table, self._described)
        self._sentences = Sentences()

    def reword(self, sentences: Sentences) -> None:
        """Replace the sentences of all actions."""
        self._sentences = sentences
        for text, number in self._numbers.items():
            entry = self._described(text)
            if self._table[number] != entry:
                self._table.change(number).update(entry)

    def words(self, text: str) -> str:
        """Return the sentence for an ``_action_lib`` atom; any other text unchanged."""
        action = action_in(text)
        return shortened(text if action is None else self._sentences.of(action))

    def _described(self, text: str) -> Record:
        """Return the terms and the words of an ``_action_lib`` atom; of any other text, the text."""
        action = action_in(text)
        if action is None:
            words = dict.fromkeys(("interface", "term", "words", "deed", "kind"), shortened(text))
            return {**words, "parameter": "", "cycle": 0, "robots": []}
        return {
            "interface": action.interface_name,
            "parameter": name_of(action.parameter),
            "cycle": action.cycle,
            "robots": actors_of(action),
            "term": shortened(text),
            "words": self.words(text),
            "deed": shortened(self._sentences.deed(action)),
            "kind": shortened(self._sentences.kind(action)),
        }


class Track:
    """Decides which poses of a robot are recorded, sparser in longer runs, and measures its way.

    Attributes:
        metres: the length of the way.

    """

    def __init__(self, most: int = POSES) -> None:
        self._most = most
        self._apart = APART
        self._measured: Optional[Point] = None  # up to which the way is measured
        self._recorded: Optional[Tuple[float, float, float]] = None
        self._count = 0
        self.metres = 0.0

    def add(self, x: float, y: float, yaw: float) -> bool:
        """Add a pose; return whether to record it."""
        way = 0.0 if self._measured is None else math.hypot(x - self._measured[0], y - self._measured[1])
        if self._measured is None or way >= APART:  # less can be noise of a standing robot
            self.metres += way
            self._measured = (x, y)
        if self._recorded is not None:
            last_x, last_y, last_yaw = self._recorded
            turned = abs(math.remainder(yaw - last_yaw, math.tau))
            if math.hypot(x - last_x, y - last_y) < self._apart and turned < TURNED:
                return False
        self._recorded, self._count = (x, y, yaw), self._count + 1
        if self._count % self._most == 0:
            self._apart *= 2.0
        return True
