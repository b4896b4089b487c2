"""A record of the core's events, for tests."""

from collections import deque
from typing import Deque, List, Tuple, Type, TypeVar

from rosoclingo.oclingo import parse_update
from rosoclingo.reasoning.events import ActionsDispatched, Event, GoalChanged, Problem, UpdateSent

_Kind = TypeVar("_Kind", bound=Event)


class Journal:
    """An observer that keeps the latest ``size`` events, oldest first."""

    def __init__(self, size: int = 10000) -> None:
        self._events: Deque[Event] = deque(maxlen=size)

    def __call__(self, event: Event) -> None:
        """Record an event."""
        self._events.append(event)

    @property
    def events(self) -> Tuple[Event, ...]:
        """Return all recorded events."""
        return tuple(self._events)

    def of(self, kind: Type[_Kind]) -> List[_Kind]:
        """Return the events of one kind."""
        return [event for event in self._events if isinstance(event, kind)]

    @property
    def updates(self) -> List[str]:
        """Return the texts of all stream updates, as the paper prints them."""
        return [str(parse_update(event.stream).plain) for event in self.of(UpdateSent)]

    @property
    def stream(self) -> str:
        """Return an online progression that replays the run: all updates in the order of the solver."""
        return "".join(event.stream for event in self.of(UpdateSent))

    @property
    def actions(self) -> List[str]:
        """Return all dispatched actions, as atoms."""
        return [str(action.atom) for event in self.of(ActionsDispatched) for action in event.actions]

    @property
    def problems(self) -> List[str]:
        """Return all reported problems."""
        return [event.message for event in self.of(Problem)]

    def states_of(self, key: str) -> List[str]:
        """Return the states of a goal so far."""
        return [event.state.value for event in self.of(GoalChanged) if event.key == key]
