"""The history of a stream: all that a solver has taken, as a list of plain values.

The state of a solver follows from its log alone. To undo is to go on from a shorter log; a solver in another process,
one beside this one, a record on disk and a replay read the same list, as lines of JSON. What a search found out is part
of it: the horizon that an update led to, and, as a checkpoint, which steps are no longer ground.
"""

import hashlib
import json
from copy import copy
from dataclasses import dataclass
from typing import Callable, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Tuple, Union

import clingo

from rosoclingo.oclingo.program.action_rules import DatedActions
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.progression.updates import Anew, Over, StreamUpdate
from rosoclingo.oclingo.solving.state_text import (
    Message,
    state_from_message,
    state_to_message,
    symbols_from_text,
    symbols_to_text,
)
from rosoclingo.oclingo.solving.stream_state import StreamState

_dated_actions = DatedActions()


class Plan(NamedTuple):
    """The actions of an answer: where a later search begins, never a part of the state.

    Attributes:
        actions: its ``_action_lib`` atoms.
        horizon: that of the answer.
        shortest: whether it was proven that there is no shorter one.

    """

    actions: FrozenSet[clingo.Symbol]
    horizon: int
    shortest: bool = False

    @classmethod
    def of(cls, atoms: Iterable[clingo.Symbol], horizon: int, shortest: bool = False) -> "Plan":
        """Return the plan in an answer, whose ``atoms`` may be other symbols as well that a ``#show`` has named."""
        return cls(_dated_actions(atoms), horizon, shortest)

    def since(self, cycle: int) -> "Plan":
        """Return what is to be done from ``cycle`` on."""
        return self._replace(actions=frozenset(one for one in self.actions if cycle_of(one) >= cycle))

    def later(self) -> "Plan":
        """Return the same done one cycle later, as where an action has failed and is tried again."""
        actions = (
            clingo.Function(one.name, [*one.arguments[:2], clingo.Number(cycle_of(one) + 1)]) for one in self.actions
        )
        return Plan(frozenset(actions), self.horizon + 1)

    @property
    def last_cycle(self) -> int:
        """The cycle of the last action; less than any where there is none."""
        return max(map(cycle_of, self.actions), default=-(2**31))


def cycle_of(action: clingo.Symbol) -> int:
    """Return the cycle of an action."""
    return int(action.arguments[2].number)


@dataclass(frozen=True)
class Taken:
    """``update`` was taken and led to ``horizon``, the last step ground; None stands for a search without an update."""

    update: Optional[StreamUpdate]
    horizon: int


@dataclass(frozen=True)
class Close:
    """``cycle`` is over: no answer holds an action of it that is not in ``executed``."""

    cycle: int
    executed: FrozenSet[clingo.Symbol]


@dataclass(frozen=True)
class Withdrawal:
    """From now on it is as if none of ``facts`` had been told; an action among them was not executed."""

    facts: FrozenSet[clingo.Symbol]


class Checkpoint:
    """All before led to :attr:`state`, which nobody changes: reading may begin here."""

    def __init__(self, state: Optional[StreamState] = None, message: Optional[Message] = None) -> None:
        """Take the state in the one form or the other, which is made of it only where it is asked for."""
        self._state, self._message = state, message

    @property
    def state(self) -> StreamState:
        """The state."""
        if self._state is None:
            assert self._message is not None
            self._state = state_from_message(self._message)
        return self._state

    @property
    def message(self) -> Message:
        """The state as a plain value that JSON knows."""
        if self._message is None:
            assert self._state is not None
            self._message = state_to_message(self._state)
        return self._message

    @property
    def reach(self) -> Tuple[int, int, int]:
        """Step, horizon, and the step before which all is over."""
        if self._state is not None:
            return self._state.step, self._state.horizon, self._state.keep_from
        return self.message["step"], self.message["horizon"], self.message["keep_from"]


Entry = Union[Taken, Close, Over, Withdrawal, Checkpoint]


class StreamLog:
    """A history up to some entry: a value, of which longer ones are made.

    Attributes:
        entry: the last entry; None where nothing was taken yet.
        before: the log without it; None as well where what lies before a checkpoint is let go.
        length: the number of entries since the last checkpoint.
        step: k, the step of the last update.
        horizon: N, the last grounded step.
        over: what concerns steps before it is over.
        plan: the last plan, where a search may begin; None where none is known. It is no part of the history.
        foreseen: whether the answer before the last entry is known to be one after it; no part of the history, either.
        reformed: whether the state was put in another form since the last checkpoint, which only a checkpoint tells.

    """

    __slots__ = (
        "_key",
        "_state",
        "before",
        "entry",
        "foreseen",
        "horizon",
        "length",
        "over",
        "plan",
        "reformed",
        "step",
    )

    def __init__(self, before: Optional["StreamLog"] = None, entry: Optional[Entry] = None) -> None:
        """Make the log ``before`` with one more ``entry``; without arguments that of a stream that begins."""
        self.before, self.entry = before, entry
        self._state: Optional[StreamState] = None
        self._key: Optional[bytes] = None
        self.length: int = 0 if before is None else before.length + 1
        self.step: int = 1 if before is None else before.step
        self.horizon: int = 1 if before is None else before.horizon
        self.over: int = 0 if before is None else before.over
        self.plan: Optional[Plan] = None if before is None else before.plan
        self.foreseen = False
        self.reformed: bool = before is not None and before.reformed and not isinstance(entry, Checkpoint)
        if isinstance(entry, Taken):
            self._reach(entry)
        elif isinstance(entry, Over):
            self.over = max(self.over, entry.step)
        elif isinstance(entry, Checkpoint):
            self.length, (self.step, self.horizon, self.over) = 0, entry.reach

    def _reach(self, entry: Taken) -> None:
        """Note how far an update leads."""
        self.horizon = entry.horizon
        if entry.update is not None:
            if Anew() in entry.update.items:
                self.step, self.over = 1, 0
            self.step = self.step if entry.update.step is None else entry.update.step
            self.over = max([self.over, *(item.step for item in entry.update.items if isinstance(item, Over))])

    @property
    def state(self) -> Optional[StreamState]:
        """The state to which it leads, None where no solver has read it yet; nobody changes it."""
        return self.entry.state if self._state is None and isinstance(self.entry, Checkpoint) else self._state

    @state.setter
    def state(self, state: StreamState) -> None:
        self._state = state

    def then(self, *entries: Entry) -> "StreamLog":
        """Return the log with further entries."""
        log = self
        for entry in entries:
            log = StreamLog(log, entry)
        return log

    def in_form(self, state: StreamState) -> "StreamLog":
        """Return the same log, whose state is known in another form, which is worth the same."""
        log = copy(self)
        log.state, log.reformed = state, True
        return log

    def less(self, facts: FrozenSet[clingo.Symbol]) -> "StreamLog":
        """Return the log after which it is as if none of ``facts`` had been told."""
        return self.then(Withdrawal(facts)) if facts else self

    def checkpoint(self) -> "StreamLog":
        """Return the log with a checkpoint of its state, which is known."""
        return self.then(Checkpoint(self.state)).cut()

    def cut(self) -> "StreamLog":
        """Let go of what lies before the last checkpoint but one: nobody goes back that far."""
        log, passed = self, 0
        while log.before is not None:
            passed += isinstance(log.entry, Checkpoint)
            if passed > 1:
                log.before = None
                break
            log = log.before
        return self

    def is_longer(self, limit: int) -> bool:
        """Whether so much more than ``limit`` entries followed the last checkpoint that another is worth its while.

        It always is for a state in another form.
        """
        assert self.state is not None
        return self.reformed or self.length > max(limit, self.state.size // 100)

    @property
    def last(self) -> Optional["StreamLog"]:
        """The log up to the last update, None where there is none or it was let go."""
        log: Optional[StreamLog] = self
        while log is not None and not (isinstance(log.entry, Taken) and log.entry.update is not None):
            log = log.before
        return log

    @property
    def update(self) -> Optional[StreamUpdate]:
        """The last update, None where there is none."""
        last = self.last
        return last.entry.update if last is not None and isinstance(last.entry, Taken) else None

    @property
    def entries(self) -> List[Entry]:
        """What another solver has to read, in order: the last checkpoint, if there is one, and all that followed."""
        return [log.entry for log in self._path() if log.entry is not None]

    def since(self, other: "StreamLog") -> Optional[List[Entry]]:
        """Return the entries that follow after ``other``; None where this log does not go on from it."""
        found: List[Entry] = []
        log: Optional[StreamLog] = self
        while log is not other:
            if log is None or log.entry is None:
                return None
            found.append(log.entry)
            log = log.before
        return found[::-1]

    @property
    def key(self) -> bytes:
        """What stands for the entries; logs in two processes that have the same ones have the same key."""
        key = b""
        for log in self._path():
            if log._key is None and log.entry is not None:
                log._key = key_after(key, entry_to_message(log.entry))
            key = log._key or b""
        return key

    def _path(self) -> List["StreamLog"]:
        """Return the logs from the last checkpoint, or the start, to this one."""
        found, log = [self], self
        while log.before is not None and not isinstance(log.entry, Checkpoint):
            log = log.before
            found.append(log)
        return found[::-1]

    def text(self) -> str:
        """Return :attr:`entries` as lines of JSON."""
        return "".join(_line(entry_to_message(entry)) for entry in self.entries)

    @classmethod
    def parse(cls, text: str) -> "StreamLog":
        """Return the log of which ``text`` holds the entries."""
        return cls().then(*(entry_from_message(json.loads(line)) for line in text.splitlines()))


def entry_to_message(entry: Entry) -> Message:
    """Return ``entry`` as a plain value that JSON knows."""
    if isinstance(entry, Taken):
        text = None if entry.update is None else str(entry.update)
        return {"do": "update", "update": text, "horizon": entry.horizon}
    if isinstance(entry, Close):
        return {"do": "close", "cycle": entry.cycle, "executed": symbols_to_text(sorted(entry.executed))}
    if isinstance(entry, Over):
        return {"do": "forget", "step": entry.step}
    if isinstance(entry, Withdrawal):
        return {"do": "withdraw", "facts": symbols_to_text(sorted(entry.facts))}
    return {"do": "checkpoint", "state": entry.message}


def entry_from_message(message: Message) -> Entry:
    """Return the entry that :func:`entry_to_message` took."""
    do = message["do"]
    if do == "update":
        text = message["update"]
        return Taken(None if text is None else parse_update(text), message["horizon"])
    if do == "close":
        return Close(message["cycle"], symbols_from_text(message["executed"]))
    if do == "forget":
        return Over(message["step"])
    if do == "withdraw":
        return Withdrawal(symbols_from_text(message["facts"]))
    return Checkpoint(message=message["state"])


def key_after(before: bytes, message: Message) -> bytes:
    """Return the key of a log of which the last entry is ``message`` and the one before has the key ``before``."""
    rest = b"" if message["do"] == "checkpoint" else before
    return hashlib.sha256(rest + _line(message).encode("ascii")).digest()


def _line(message: Message) -> str:
    return json.dumps(message, separators=(",", ":")) + "\n"


class LoggedSolver:
    """What a solver has of its log alone, wherever it works."""

    def __init__(self) -> None:
        self._log = StreamLog()
        self._under_way: Callable[[], int] = lambda: 0  # what a search has ground up to now

    @property
    def log(self) -> StreamLog:
        """All that was taken: the solver's state follows from it, and so does any other solver's that reads it."""
        return self._log

    @property
    def horizon(self) -> int:
        """N, the last grounded step."""
        return self._log.horizon

    @property
    def reached(self) -> int:
        """The last step that is ground in the midst of a search; the horizon between two of them."""
        return max(self.horizon, self._under_way())

    @property
    def step(self) -> int:
        """k, the step of the last update."""
        return self._log.step

    def restore(self, log: StreamLog) -> None:
        """Go on from a ``log``, an earlier one of this solver or any other; it is read when there is need."""
        self._log = log

    def prepare(self, update: StreamUpdate, before: Sequence[StreamUpdate] = ()) -> bool:
        """Have the answer to ``update`` prepared, should it come after those ``before``; tell whether that is done.

        Where nothing can do so beside, it is not.
        """
        return False

    def has_prepared(self, update: StreamUpdate) -> bool:
        """Whether the answer to ``update`` is there, should it come next."""
        return False

    def shorten_log(self, stopped: Optional[Callable[[], bool]] = None) -> None:
        """Put a checkpoint at the end of a log that has grown long; one that never does stays as it is."""

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Fix the actions of ``cycle``: no answer will hold an ``_action_lib(A,P,cycle)`` that is not in ``executed``.

        Its returns may still come with the next update; those of the cycle closed before it are closed.
        """
        self._log = self._log.then(Close(cycle, frozenset(executed)))

    def forget_before(self, step: int) -> None:
        """Let the steps before ``step`` be over: no update will concern them any more.

        What is decided at them is kept as facts and no longer ground, which keeps a long stream as fast as a short one;
        their externals are closed, so that a fact for one of them is ignored with a warning. For ``shortest`` solvers
        alone.
        """
        self._log = self._log.then(Over(step))
