"""Between the core and the outside: the core's events go out once the state that led to them is written."""

from typing import Callable, Dict, Iterable, List, NamedTuple, Optional, Tuple

from rosoclingo.reasoning.events import Event, GoalChanged, GoalRefused, GoalUnmet, Observer
from rosoclingo.reasoning.given_up import GivenUpGoals
from rosoclingo.reasoning.goals import GoalState, Outcome
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.journal.kept_core import KeptCore
from rosoclingo.reasoning.records import Record, group


class Ending(NamedTuple):
    """How a client's goal has ended."""

    state: GoalState
    outcome: Outcome
    message: str


class ClientGoal(NamedTuple):
    """A client's goal as it came, at ``stamp`` (seconds and nanoseconds), from then on until its end is told.

    ``cancelled`` tells whether the client has asked to cancel it.
    """

    text: str
    stamp: Tuple[int, int]
    cancelled: bool = False
    ending: Optional[Ending] = None

    def record(self) -> Record:
        """Return all as a plain value."""
        end = self.ending
        ending = end and {"state": end.state.value, "outcome": int(end.outcome), "message": end.message}
        return {**self._asdict(), "stamp": list(self.stamp), "ending": ending}

    @classmethod
    def of_record(cls, record: Record) -> "ClientGoal":
        """Return the goal of :meth:`record`."""
        end = record["ending"]
        ending = end and Ending(GoalState(end["state"]), Outcome(end["outcome"]), end["message"])
        return cls(**{**record, "stamp": tuple(record["stamp"]), "ending": ending})


class Keeper:
    """Collects the core's events, and lets them out step by step, after the journal has the state that led to them.

    Attributes:
        clients: the clients' goals by their keys, in order of arrival.
        given_up: the goals that were given up because there is no plan.

    """

    def __init__(
        self,
        tell: Observer,
        journal: Optional[Journal],
        now: Callable[[], float],
        time: Optional[Callable[[], float]] = None,
        fault: str = "",
    ) -> None:
        """Let events out by ``tell``.

        ``now`` is a monotonic clock, ``time`` the run's clock, whose time is written; both in seconds. ``fault`` is why
        there is no journal though one is wanted.
        """
        self._tell, self._journal, self._now, self._time, self._fault = tell, journal, now, time, fault
        self._core: Optional[KeptCore] = None
        self._state: Record = {}
        self._events: List[Event] = []
        self.clients: Dict[str, ClientGoal] = {}
        self.given_up = GivenUpGoals()

    def __call__(self, event: Event) -> None:
        """Collect what the core tells: its observer."""
        self._events.append(event)

    def attach(self, core: KeptCore, record: Optional[Record] = None) -> None:
        """Keep this core, which may have been made of a ``record``; then all is written down again."""
        self._core = core
        if record is not None:
            self.clients = {key: ClientGoal.of_record(value) for key, value in group(record, "client").items()}
            self.given_up.restore(record)
        self._look()
        self._write()

    def forget(self, keys: Iterable[str]) -> None:
        """Clients need not be told of the ends of these goals any more."""
        for key in keys:
            self.clients.pop(key, None)

    @property
    def fault(self) -> str:
        """Why nothing is written at present, empty where all is well."""
        return self._fault if self._journal is None else self._journal.fault

    def add(self, key: str, client: ClientGoal) -> None:
        """A client's goal has arrived; :meth:`keep` it before the client hears of that."""
        self.clients[key] = client

    def cancel(self, key: str) -> None:
        """A client wants its goal to be cancelled; :meth:`keep` that before the client hears of it."""
        if key in self.clients:
            self.clients[key] = self.clients[key]._replace(cancelled=True)

    def end(self, key: str, ending: Ending) -> None:
        """A goal that the core has not heard of ends; :meth:`keep` that before the client hears of it."""
        self.clients[key] = self.clients[key]._replace(ending=ending)

    def keep(self) -> None:
        """Write the arrivals, also within a step of the core."""
        self._write()

    def send(self, keep_ends: bool = False) -> None:
        """Write the state after a step of the core, and let its events out; also to be called if nothing happens.

        The disk has the state before any event goes out. With ``keep_ends`` ended goals stay
        in the journal until :meth:`forget`, because their clients may not hear yet.
        """
        if not self._events:
            if self._journal is not None and self._journal.is_due(self._now()):
                self._look()
                self._write()
            return
        events, self._events = self._events, []
        ends = [key for key in map(self._note, events) if key is not None]
        self._look()
        self._write()
        for event in events:
            self._tell(event)
        if not keep_ends:
            self.forget(ends)

    def close(self) -> None:
        """Write no more, and unlock the journal."""
        if self._journal is not None:
            self._journal.close()
            self._journal = None

    def _look(self) -> None:
        assert self._core is not None
        if self._journal is not None:
            self._state = self._core.record()

    def _write(self) -> None:
        if self._journal is None:
            return
        clients = {f"client:{key}": client.record() for key, client in self.clients.items()}
        time = None if self._time is None else self._time()
        self._journal.write({**self._state, **clients, **self.given_up.record()}, self._now(), time)

    def _note(self, event: Event) -> Optional[str]:
        """Note the end of a client's goal, and return its key; note a goal that is given up."""
        if isinstance(event, GoalUnmet):
            self.given_up.add(event)
        if isinstance(event, GoalRefused):
            ending = Ending(GoalState.REJECTED, Outcome.REJECTED, event.message)
        elif isinstance(event, GoalChanged) and event.outcome is not None:
            ending = Ending(event.state, event.outcome, event.message)
        else:
            return None
        if event.key not in self.clients:
            return None
        self.end(event.key, ending)
        return event.key
