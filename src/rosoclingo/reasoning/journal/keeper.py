"""Between the core and the outside: what the core tells goes out once its state is written down."""

from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple, Type

from rosoclingo.common import durable
from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.events import Event, GoalChanged, GoalRefused, GoalUnmet, Observer
from rosoclingo.reasoning.given_up import GivenUpGoals
from rosoclingo.reasoning.goals import GoalState, Outcome
from rosoclingo.reasoning.journal.folder import AnyJournal
from rosoclingo.reasoning.journal.kept_core import KeptCore
from rosoclingo.reasoning.journal.written_ahead import FOLLOWING, WrittenAhead
from rosoclingo.reasoning.records import Record, group


class Ending(NamedTuple):
    """How a client's goal has ended."""

    state: GoalState
    outcome: Outcome
    message: str


class Client(NamedTuple):
    """A client's goal as it came, at ``stamp`` (seconds and nanoseconds), from then on until its end is told.

    ``cancelled`` tells whether the client has asked to cancel it.
    """

    text: str
    stamp: Tuple[int, int]
    cancelled: bool = False
    ending: Optional[Ending] = None

    def record(self) -> List[Any]:
        """Return all as a plain value."""
        end = self.ending
        return [
            self.text,
            *self.stamp,
            self.cancelled,
            end and [end.state.value, int(end.outcome), end.message],
        ]

    @classmethod
    def of_record(cls, record: Sequence[Any]) -> "Client":
        """Return the goal of :meth:`record`."""
        text, seconds, nanoseconds, cancelled, end = record
        ending = None if end is None else Ending(GoalState(end[0]), Outcome(end[1]), end[2])
        return cls(text, (seconds, nanoseconds), cancelled, ending)


class Keeper:
    """Collects what a core tells, and lets it out step by step, each after the journal has the state that led to it.

    Attributes:
        clients: the clients' goals by their keys, in order of arrival.
        given_up: the goals that were given up for want of a plan.

    """

    def __init__(
        self,
        tell: Observer,
        journal: Optional[AnyJournal],
        now: Callable[[], float],
        time: Optional[Callable[[], float]] = None,
    ) -> None:
        """Let things out by ``tell``.

        ``now`` is a clock that only goes forward, ``time`` the run's clock, which is written down; both in seconds.
        """
        self._tell, self._journal, self._now, self._time = tell, journal, now, time
        self._core: Optional[KeptCore] = None
        self._state: Record = {}
        self._events: List[Event] = []
        self._plan, self._ahead = TaskPlan(), WrittenAhead()
        self.clients: Dict[str, Client] = {}
        self.given_up = GivenUpGoals()

    def __call__(self, event: Event) -> None:
        """Collect what the core tells: its observer."""
        self._events.append(event)

    def attach(self, core: KeptCore, record: Optional[Record] = None) -> None:
        """Keep this core, which may have been made of a ``record``; then all is written down again."""
        self._core = core
        if record is not None:
            self.clients = {key: Client.of_record(value) for key, value in group(record, "client").items()}
            self.given_up.restore(record)
        if self._journal is not None:
            self._look()
            self._write()

    def forget(self, keys: Iterable[str]) -> None:
        """Clients need not be told of the ends of these goals any more."""
        for key in keys:
            self.clients.pop(key, None)

    @property
    def fault(self) -> str:
        """Why nothing is written at present, empty where all is well."""
        return "" if self._journal is None else self._journal.fault

    def add(self, key: str, client: Client) -> None:
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
        """Write down what has arrived, while the core may be in the midst of a step."""
        if self._journal is not None:
            self._write()

    def send(self, keep_ends: bool = False) -> None:
        """Write down the state after a step of the core, and let out what it told; also while nothing happens.

        The disk has it before anything goes out that the outside acts on; actions that its plan says already go first.
        With ``keep_ends`` goals that have ended stay written down until :meth:`forget`: their clients may not hear yet.
        """
        if not self._events:
            if self._journal is not None and self._journal.is_due(self._now()):
                self._look()
                self._write()
            return
        events, self._events = self._events, []
        ends = [key for key in map(self._note, events) if key is not None]
        at_once: Tuple[Type[Event], ...] = ()
        if self._journal is not None:
            self._look()
            at_once = FOLLOWING if self._ahead.covers(events, self._plan) else ()
            self._write(wait=not at_once and any(event.is_news for event in events))
        for event in events:
            if event.is_news and not isinstance(event, at_once):
                self.settle()
            self._tell(event)
        if not keep_ends:
            self.forget(ends)

    def settle(self) -> None:
        """Have on disk what was written down without waiting for that, while there is nothing else to do."""
        if self._journal is not None:
            self._journal.settle(self._now())
            self._note_disk()

    def close(self) -> None:
        """Write no more, and leave the journal to others."""
        if self._journal is not None:
            self._journal.close()
            self._journal = None

    def _look(self) -> None:
        assert self._core is not None
        self._state, self._plan = self._core.record(), self._core.plan

    def _write(self, wait: bool = True) -> None:
        assert self._journal is not None
        clients = {f"client:{key}": client.record() for key, client in self.clients.items()}
        time = None if self._time is None else self._time()
        machine = {"machine": durable.machine()}
        self._journal.write({**self._state, **machine, **clients, **self.given_up.record()}, self._now(), time, wait)
        if wait:
            self._note_disk()

    def _note_disk(self) -> None:
        """The disk has all, unless it fails."""
        self._ahead.on_disk(None if self.fault else self._plan)

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
