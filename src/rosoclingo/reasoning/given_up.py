"""The goals that were given up for want of a plan, with what there is to tell about why: the latest ones."""

import json
from typing import Dict, List, Optional, Tuple

from clingo import Symbol

from rosoclingo.planning.explaining.questions import stream_from_message, stream_to_message
from rosoclingo.reasoning.events import GoalUnmet
from rosoclingo.reasoning.keywords import identifier_of
from rosoclingo.reasoning.records import Record, group, symbol_of, text_of

#: Limits of the remembered goals: their number, and their bytes.
KEPT, MEMORY = 20, 16 * 1024 * 1024

#: Bytes that they may take in a record, of which the latest goals come first.
ROOM = 256 * 1024


class GivenUpGoals:
    """Remembers the last :data:`KEPT` aborted goals: the last one, and others within :data:`MEMORY`.

    A record has those of them that fit in :data:`ROOM`.
    """

    def __init__(self) -> None:
        self._goals: Dict[str, GoalUnmet] = {}
        self._records: Dict[str, Tuple[Record, int]] = {}  # by the goal's key, with its bytes

    def add(self, event: GoalUnmet) -> None:
        """Remember a goal, the latest one."""
        self._drop(event.key)
        self._goals[event.key] = event
        sizes = {key: self._record_of(key)[1] for key in self._goals}
        while len(self._goals) > KEPT or (len(self._goals) > 1 and sum(sizes[key] for key in self._goals) > MEMORY):
            self._drop(next(iter(self._goals)))

    @property
    def terms(self) -> List[Symbol]:
        """The goals, oldest first."""
        return [one.term for one in self._goals.values()]

    def find(self, name: str) -> Optional[GoalUnmet]:
        """Return the goal of that key, text or identifier that was given up last."""
        if name in self._goals:
            return self._goals[name]
        text = name.replace(" ", "")
        named = (one for one in reversed(list(self._goals.values())) if text in _names(one.term))
        return next(named, None)

    def record(self) -> Record:
        """Return the goals as sections of plain values that JSON knows."""
        found: List[Tuple[str, Record]] = []
        room = ROOM
        for key in reversed(list(self._goals)):
            value, size = self._record_of(key)
            room -= size
            if room < 0:
                break
            found.append((f"unmet:{key}", value))
        return dict(reversed(found))

    def restore(self, record: Record) -> None:
        """Remember the goals of a :meth:`record`, which may lack them."""
        for key, goal in group(record, "unmet").items():
            self.add(GoalUnmet(goal["cycle"], key, symbol_of(goal["term"]), stream_from_message(goal["stream"])))

    def _record_of(self, key: str) -> Tuple[Record, int]:
        if key not in self._records:
            event = self._goals[key]
            stream = stream_to_message(event.stream)
            value = {"cycle": event.cycle, "term": text_of(event.term), "stream": stream}
            self._records[key] = value, len(json.dumps(value))
        return self._records[key]

    def _drop(self, key: str) -> None:
        self._goals.pop(key, None)
        self._records.pop(key, None)


def _names(term: Symbol) -> Tuple[str, str]:
    return str(term), str(identifier_of(term))
