"""The latest goals that were aborted for lack of a plan, with the streams that explain why."""

import json
from typing import Dict, List, Optional

from clingo import Symbol

from rosoclingo.reasoning.events import GoalUnmet
from rosoclingo.reasoning.keywords import identifier_of
from rosoclingo.reasoning.records import PersistentPart, Record, codec, tables

#: Maximum number of goals, and maximum size of their record in bytes; the latest goals are recorded first.
KEPT, ROOM = 20, 256 * 1024


_CODEC = codec(GoalUnmet)


class AbortedGoals(PersistentPart):
    """Keeps the last :data:`KEPT` unmet goals; a record contains the latest of them, up to :data:`ROOM` bytes."""

    GROUP = "aborted"
    TABLES = tables(_recorded=("unmet", str, dict))

    def __init__(self) -> None:
        self._goals: Dict[str, GoalUnmet] = {}
        self._recorded: Dict[str, Record] = {}

    def add(self, event: GoalUnmet) -> None:
        """Add a goal as the latest one."""
        for goals in (self._goals, self._recorded):
            goals.pop(event.key, None)
        self._goals[event.key] = event
        if len(self._goals) > KEPT:
            del self._goals[next(iter(self._goals))]
        row = _CODEC.encode(event)
        self._recorded[event.key] = {**row, "size": len(json.dumps(row))}
        while len(self._recorded) > KEPT or sum(one["size"] for one in self._recorded.values()) > ROOM:
            del self._recorded[next(iter(self._recorded))]

    @property
    def terms(self) -> List[Symbol]:
        """The goals, oldest first."""
        return [one.term for one in self._goals.values()]

    def find(self, name: str) -> Optional[GoalUnmet]:
        """Return the latest goal with this key, text or identifier, None if there is none."""
        if name in self._goals:
            return self._goals[name]
        text = name.replace(" ", "")
        events = reversed(list(self._goals.values()))
        return next((one for one in events if text in (str(one.term), str(identifier_of(one.term)))), None)

    def restore(self, record: Record) -> None:
        """Restore the goals of a record."""
        super().restore(record)
        self._goals = {key: _CODEC.decode(row) for key, row in self._recorded.items()}
