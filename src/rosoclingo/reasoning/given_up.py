"""The goals that were given up for want of a plan, with what there is to tell about why: the latest ones."""

import json
from itertools import accumulate
from typing import Dict, List, Optional, Tuple

from clingo import Symbol

from rosoclingo.planning.explaining.questions import stream_from_message, stream_to_message
from rosoclingo.reasoning.events import GoalUnmet
from rosoclingo.reasoning.keywords import identifier_of
from rosoclingo.reasoning.records import Record, group, symbol_of, text_of

#: Limit of the remembered goals, and of the bytes that they can take in a record, in which the latest come first.
KEPT, ROOM = 20, 256 * 1024


class GivenUpGoals:
    """Remembers the last :data:`KEPT` aborted goals; a record has those of them that fit in :data:`ROOM`."""

    def __init__(self) -> None:
        self._goals: Dict[str, Tuple[GoalUnmet, Record, int]] = {}  # by key, each with its record and the bytes of that

    def add(self, event: GoalUnmet) -> None:
        """Remember a goal, the latest one."""
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
        """Return the goal of that key, text or identifier that was given up last."""
        if name in self._goals:
            return self._goals[name][0]
        text = name.replace(" ", "")
        events = (one for one, *_ in reversed(list(self._goals.values())))
        return next((one for one in events if text in (str(one.term), str(identifier_of(one.term)))), None)

    def record(self) -> Record:
        """Return the goals as sections of plain values that JSON knows."""
        latest = list(reversed(list(self._goals.items())))
        sizes = accumulate(size for _, (_, _, size) in latest)
        fitting = [(f"unmet:{key}", value) for (key, (_, value, _)), size in zip(latest, sizes) if size <= ROOM]
        return dict(reversed(fitting))

    def restore(self, record: Record) -> None:
        """Remember the goals of a :meth:`record`, which may lack them."""
        for key, goal in group(record, "unmet").items():
            self.add(GoalUnmet(goal["cycle"], key, symbol_of(goal["term"]), stream_from_message(goal["stream"])))
