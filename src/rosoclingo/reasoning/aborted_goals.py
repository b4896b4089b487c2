"""The latest goals that were aborted for lack of a plan, with the streams that explain why."""

from typing import Dict, List, Optional

from clingo import Symbol

from rosoclingo.reasoning.events import GoalUnmet
from rosoclingo.reasoning.keywords import identifier_of
from rosoclingo.reasoning.records import PersistentPart, tables

#: Maximum number of goals.
KEPT = 20


class AbortedGoals(PersistentPart):
    """Keeps the last :data:`KEPT` unmet goals."""

    GROUP = "aborted"
    TABLES = tables(_goals=("unmet", str, GoalUnmet))

    def __init__(self) -> None:
        self._goals: Dict[str, GoalUnmet] = {}

    def add(self, event: GoalUnmet) -> None:
        """Add a goal as the latest one."""
        self._goals.pop(event.key, None)
        self._goals[event.key] = event
        if len(self._goals) > KEPT:
            del self._goals[next(iter(self._goals))]

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
