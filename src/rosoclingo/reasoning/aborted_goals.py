"""The latest goals that were aborted for lack of a plan, with the streams that explain why."""

import json
from itertools import accumulate
from typing import Dict, List, Optional, Tuple

from clingo import Symbol

from rosoclingo.planning.explaining.questions import stream_from_message, stream_to_message
from rosoclingo.reasoning.events import GoalUnmet
from rosoclingo.reasoning.keywords import identifier_of
from rosoclingo.reasoning.records import Record, group, symbol_of, text_of

#: Maximum number of goals, and maximum size of their record in bytes; the latest goals are recorded first.
KEPT, ROOM = 20, 256 * 1024


class AbortedGoals:
    """Keeps the last :data:`KEPT` unmet goals; a record contains the latest of them, up to :data:`ROOM` bytes."""

    def __init__(self) -> None:
        self._goals: Dict[str, Tuple[GoalUnmet, Record, int]] = {}  # key -> event, record, size of the record in bytes

    def add(self, event: GoalUnmet) -> None:
        """Add a goal as the latest one."""
        stream = stream_to_message(event.stream)
        value = {"cycle": event.cycle, "term": text_of(event.term), "stream": stream}
        self._goals.pop(event.key, None)
        self._goals[event.key] = event, value, len(json.dumps(value))
        if len(self._goals) > KEPT:
            del self._goals[next(iter(self._goals))]

    @property
    def terms(self) -> List[Symbol]:
        """The goals, oldest first."""
        return [one.term for one, *_ in self._goals.values()]

    def find(self, name: str) -> Optional[GoalUnmet]:
        """Return the latest goal with this key, text or identifier, None if there is none."""
        if name in self._goals:
            return self._goals[name][0]
        text = name.replace(" ", "")
        events = (one for one, *_ in reversed(list(self._goals.values())))
        return next((one for one in events if text in (str(one.term), str(identifier_of(one.term)))), None)

    def record(self) -> Record:
        """Return the goals as sections of JSON values."""
        latest = list(reversed(list(self._goals.items())))
        sizes = accumulate(size for _, (_, _, size) in latest)
        fitting = [(f"unmet:{key}", value) for (key, (_, value, _)), size in zip(latest, sizes) if size <= ROOM]
        return dict(reversed(fitting))

    def restore(self, record: Record) -> None:
        """Add the goals of a :meth:`record`, if it has any."""
        for key, goal in group(record, "unmet").items():
            self.add(GoalUnmet(goal["cycle"], key, symbol_of(goal["term"]), stream_from_message(goal["stream"])))
