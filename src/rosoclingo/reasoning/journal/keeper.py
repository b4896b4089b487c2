"""The keeper: it releases events of the core after the state that led to them is durable."""

from typing import Callable, Dict, Iterable, List, NamedTuple, Optional, Tuple

from rosoclingo.reasoning.aborted_goals import AbortedGoals
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import Event, GoalChanged, GoalUnmet, Observer
from rosoclingo.reasoning.goals import TRANSITIONS, GoalEvent, GoalState, Outcome
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.records import ChangeRecorder, PersistentPart, Record, record_of, tables


class Ending(NamedTuple):
    """The end of a client's goal."""

    state: GoalState
    outcome: Outcome
    message: str


class ClientGoal(NamedTuple):
    """A client's goal, from its arrival until its end is reported.

    Attributes:
        text: the goal as it was sent.
        stamp: its time stamp, in seconds and nanoseconds.
        cancelled: whether the client has cancelled it.
        ending: its end, None while it is live.

    """

    text: str
    stamp: Tuple[int, int]
    cancelled: bool = False
    ending: Optional[Ending] = None

    def state(self, in_core: Optional[GoalState]) -> GoalState:
        """Return the state of the goal for its client; ``in_core`` is None if the core does not have the goal."""
        if self.ending is not None:
            return self.ending.state
        state = in_core or GoalState.PENDING
        return TRANSITIONS.get((state, GoalEvent.CANCEL_REQUEST), state) if self.cancelled else state


class Keeper(PersistentPart):
    """Collects the core's events, and releases them once the journal contains the state that led to them.

    Attributes:
        clients: the clients' goals by their keys, in order of arrival.
        aborted_goals: the latest goals that were aborted for lack of a plan.

    """

    GROUP = "keeper"
    TABLES = tables(clients=("client", str, ClientGoal))

    def __init__(
        self,
        emit: Observer,
        journal: Optional[Journal],
        now: Callable[[], float],
        time: Callable[[], float],
        fault: str = "",
    ) -> None:
        """Release events to ``emit``.

        ``now`` is a monotonic clock, and ``time`` the run's clock, whose time is recorded; both in seconds. ``fault``
        is the reason why a requested journal is missing, empty for none.
        """
        self._emit, self._journal, self._now, self._time, self._fault = emit, journal, now, time, fault
        self._core: Optional[Core] = None
        self._recorder = ChangeRecorder()
        self._events: List[Event] = []
        self.clients: Dict[str, ClientGoal] = {}
        self.aborted_goals = AbortedGoals()

    def __call__(self, event: Event) -> None:
        """Collect an event, as the observer of the core."""
        self._events.append(event)

    def attach(self, core: Core, record: Optional[Record] = None) -> None:
        """Record the state of this core from now on; ``record`` is the one from which the core was resumed, if any."""
        self._core = core
        if record is not None:
            self.restore(record)
            self.aborted_goals.restore(record)
        self._write_all()

    def forget(self, keys: Iterable[str]) -> None:
        """Remove goals whose ends have been reported to their clients."""
        for key in keys:
            self.clients.pop(key, None)

    @property
    def fault(self) -> str:
        """Why no journal is written at present, empty for none."""
        return self._fault if self._journal is None else self._journal.fault

    def add(self, key: str, client: ClientGoal) -> None:
        """Add a client's goal; call :meth:`keep` before reporting it to the client."""
        self.clients[key] = client

    def cancel(self, key: str) -> None:
        """Mark a goal as cancelled; call :meth:`keep` before reporting this to the client."""
        if key in self.clients:
            self.clients[key] = self.clients[key]._replace(cancelled=True)

    def end(self, key: str, ending: Ending) -> None:
        """End a goal that the core has not received; call :meth:`keep` before reporting this to the client."""
        self.clients[key] = self.clients[key]._replace(ending=ending)

    def keep(self) -> None:
        """Write the arrivals; can be called within a step of the core."""
        self._write([self])

    def send(self, keep_ends: bool = False) -> None:
        """Write the state after a step of the core, and then release its events.

        Call it also while nothing happens, to repeat failed writes. With ``keep_ends``, ended goals stay in the journal
        until :meth:`forget`, because their clients may not be connected yet.
        """
        if not self._events:
            if self._journal is not None and self._journal.is_due(self._now()):
                self._write_all()
            return
        events, self._events = self._events, []
        ends = [key for key in map(self._note, events) if key is not None]
        self._write_all()
        for event in events:
            self._emit(event)
        if not keep_ends:
            self.forget(ends)

    def close(self) -> None:
        """Close and unlock the journal."""
        if self._journal is not None:
            self._journal.close()
            self._journal = None

    def _write_all(self) -> None:
        """Write the state after a step of the core."""
        if self._journal is not None:
            assert self._core is not None
            parts = (*self._core.parts, self, self.aborted_goals)
            self._write(parts, lambda: record_of(parts))

    def _write(self, parts: Iterable[PersistentPart], state: Optional[Callable[[], Record]] = None) -> None:
        """Write the changes of some ``parts``; ``state`` returns the whole state, None within a step of the core."""
        if self._journal is not None:
            self._journal.write(self._recorder.changes(parts), state, self._now(), self._time())

    def _note(self, event: Event) -> Optional[str]:
        """Record the end of a client's goal and return its key, None for other events; record unmet goals."""
        if isinstance(event, GoalUnmet):
            self.aborted_goals.add(event)
        if not isinstance(event, GoalChanged) or event.outcome is None or event.key not in self.clients:
            return None
        self.end(event.key, Ending(event.state, event.outcome, event.message))
        return event.key
