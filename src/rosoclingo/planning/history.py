"""The history of a stream: accepted updates, adopted plans and checkpoints, as a list of plain values.

It is the only state: undo is a shorter history; workers, the journal and replay read the same list, as lines of JSON.
"""

import hashlib
import json
from dataclasses import dataclass
from typing import FrozenSet, Iterable, List, NamedTuple, Optional, Tuple, Union

import clingo

from rosoclingo.oclingo.program.action_rules import DatedActions
from rosoclingo.oclingo.program.update_reader import Reader
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.progression.updates import Anew, Over, StreamUpdate, Withdraw
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.text import (
    Message,
    snapshot_from_message,
    snapshot_to_message,
    symbols_from_text,
    symbols_to_text,
)

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

    @classmethod
    def in_result(cls, result: SolveResult) -> "Optional[Plan]":
        """Return the plan in the last answer, None if there is no answer."""
        return cls.of(result.answers[-1], result.horizon, result.shortest) if result.answers else None

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
class AcceptedUpdate:
    """``update`` was accepted and led to ``horizon``, the last ground step; None stands for a search without an update.

    ``predicted``: the answer before it is one after it as well, so that it took no search.
    """

    update: Optional[StreamUpdate]
    horizon: int
    predicted: bool = False


@dataclass(frozen=True)
class AdoptedPlan:
    """``plan`` is in force, and later searches begin with it. It does not change the snapshot."""

    plan: Plan


class Checkpoint:
    """All before led to :attr:`snapshot`: reading may begin here."""

    def __init__(self, snapshot: Optional[Snapshot] = None, message: Optional[Message] = None) -> None:
        """Take the snapshot, or its message, from which it is made only if it is asked for."""
        self._snapshot, self._message = snapshot, message

    @property
    def snapshot(self) -> Snapshot:
        """The snapshot."""
        if self._snapshot is None:
            assert self._message is not None
            self._snapshot = snapshot_from_message(self._message)
        return self._snapshot

    @property
    def message(self) -> Message:
        """The snapshot as a plain value that JSON knows."""
        if self._message is None:
            assert self._snapshot is not None
            self._message = snapshot_to_message(self._snapshot)
        return self._message

    @property
    def reach(self) -> Tuple[int, int, int]:
        """Step, horizon, and the step before which all is over."""
        if self._snapshot is not None:
            return self._snapshot.step, self._snapshot.horizon, self._snapshot.keep_from
        return self.message["step"], self.message["horizon"], self.message["keep_from"]


Entry = Union[AcceptedUpdate, AdoptedPlan, Checkpoint]


class History:
    """A history up to its last entry: an immutable list of which longer ones are made.

    Attributes:
        entry: the last entry; None for the empty history.
        before: the history without it; None as well if what lies before a checkpoint was released.
        length: the number of updates since the last checkpoint.
        step: k, the step of the last update.
        horizon: N, the last ground step.
        over: steps before it are over.
        plan: the plan in force, None for none.

    """

    __slots__ = ("_key", "_line", "_snapshot", "before", "entry", "horizon", "length", "over", "plan", "step")

    def __init__(self, before: Optional["History"] = None, entry: Optional[Entry] = None) -> None:
        """Append ``entry`` to the history ``before``; without arguments the history is empty."""
        self.before, self.entry = before, entry
        self._snapshot: Optional[Snapshot] = None
        self._key: Optional[bytes] = None
        self._line: Optional[str] = None
        self.length: int = 0 if before is None else before.length + isinstance(entry, AcceptedUpdate)
        self.step: int = 1 if before is None else before.step
        self.horizon: int = 1 if before is None else before.horizon
        self.over: int = 0 if before is None else before.over
        self.plan: Optional[Plan] = None if before is None else before.plan
        if isinstance(entry, AcceptedUpdate):
            self._reach(entry)
        elif isinstance(entry, AdoptedPlan):
            self.plan = entry.plan
        elif isinstance(entry, Checkpoint):
            self.length, (self.step, self.horizon, self.over) = 0, entry.reach

    def _reach(self, entry: AcceptedUpdate) -> None:
        """Note how far an update leads."""
        self.horizon = entry.horizon
        if entry.update is not None:
            if Anew() in entry.update.items:
                self.step, self.over = 1, 0
            self.step = self.step if entry.update.step is None else entry.update.step
            self.over = max([self.over, *(item.step for item in entry.update.items if isinstance(item, Over))])

    def snapshot(self, reader: Reader) -> Snapshot:
        """Return the snapshot to which it leads; computed once for each history."""
        unread: List[History] = []
        known = self
        while known._snapshot is None and known.before is not None and not isinstance(known.entry, Checkpoint):
            unread.append(known)
            known = known.before
        if known._snapshot is None:
            first = known.entry.snapshot if isinstance(known.entry, Checkpoint) else Snapshot.first(reader.program)
            known._snapshot = fold(first, known.entry, reader)
        snapshot = known._snapshot
        for one in reversed(unread):
            snapshot = one._snapshot = fold(snapshot, one.entry, reader)
        return snapshot

    def then(self, *entries: Entry) -> "History":
        """Return the log with further entries."""
        log = self
        for entry in entries:
            log = History(log, entry)
        return log

    def without(self, facts: FrozenSet[clingo.Symbol]) -> "History":
        """Return the history after which it is as if none of ``facts`` had been asserted.

        An action among them was not executed.
        """
        withdrawn = StreamUpdate(items=tuple(map(Withdraw, sorted(facts))))
        return self.then(AcceptedUpdate(withdrawn, self.horizon)) if facts else self

    def adopt(self, plan: Optional[Plan]) -> "History":
        """Return the history with ``plan`` in force; this one if there is none, or it is in force already."""
        return self if plan is None or plan == self.plan else self.then(AdoptedPlan(plan))

    def checkpoint(self, snapshot: Snapshot) -> "History":
        """Return the history with a checkpoint of its ``snapshot``, or an equivalent one; its plan stays in force."""
        plan = () if self.plan is None else (AdoptedPlan(self.plan),)
        return self.then(Checkpoint(snapshot), *plan).cut()

    @property
    def without_plan(self) -> "History":
        """The history without the plans that were adopted at its end."""
        log = self
        while isinstance(log.entry, AdoptedPlan) and log.before is not None:
            log = log.before
        return log

    @property
    def predicted(self) -> bool:
        """Whether the last update took no search."""
        last = self.last
        return last is not None and isinstance(last.entry, AcceptedUpdate) and last.entry.predicted

    def cut(self) -> "History":
        """Let go of what lies before the last checkpoint but one: nobody goes back that far."""
        log, passed = self, 0
        while log.before is not None:
            passed += isinstance(log.entry, Checkpoint)
            if passed > 1:
                log.before = None
                break
            log = log.before
        return self

    def is_longer(self, limit: int, snapshot: Snapshot) -> bool:
        """Whether so much more than ``limit`` entries followed the last checkpoint that another is worth its while."""
        return self.length > max(limit, snapshot.size // 100)

    @property
    def last(self) -> Optional["History"]:
        """The log up to the last update, None where there is none or it was let go."""
        log: Optional[History] = self
        while log is not None and not (isinstance(log.entry, AcceptedUpdate) and log.entry.update is not None):
            log = log.before
        return log

    @property
    def update(self) -> Optional[StreamUpdate]:
        """The last update, None where there is none."""
        last = self.last
        return last.entry.update if last is not None and isinstance(last.entry, AcceptedUpdate) else None

    @property
    def entries(self) -> List[Entry]:
        """What another solver has to read, in order: the last checkpoint, if there is one, and all that followed."""
        return [log.entry for log in self._path() if log.entry is not None]

    def since(self, other: "History") -> Optional[List[Entry]]:
        """Return the entries that follow after ``other``; None where this log does not go on from it."""
        found: List[Entry] = []
        log: Optional[History] = self
        while log is not other:
            if log is None or log.entry is None:
                return None
            found.append(log.entry)
            log = log.before
        return found[::-1]

    @property
    def key(self) -> bytes:
        """A hash of the entries that the snapshot follows from; plans are left out."""
        key = b""
        for log in self._path():
            if log._key is None:
                entry = log.entry
                log._key = (
                    key if entry is None or isinstance(entry, AdoptedPlan) else key_after(key, entry_to_message(entry))
                )
            key = log._key
        return key

    def _path(self) -> List["History"]:
        """Return the logs from the last checkpoint, or the start, to this one."""
        found, log = [self], self
        while log.before is not None and not isinstance(log.entry, Checkpoint):
            log = log.before
            found.append(log)
        return found[::-1]

    def text(self) -> str:
        """Return :attr:`entries` as lines of JSON."""
        return "".join(log.line for log in self._path() if log.entry is not None)

    @property
    def line(self) -> str:
        """The last entry as a line of JSON."""
        if self._line is None and self.entry is not None:
            self._line = entry_to_line(self.entry)
        return self._line or ""

    @classmethod
    def parse(cls, text: str) -> "History":
        """Return the log of which ``text`` holds the entries."""
        return cls().then(*(entry_from_message(json.loads(line)) for line in text.splitlines()))


def fold(snapshot: Snapshot, entry: Optional[Entry], reader: Reader) -> Snapshot:
    """Return the snapshot after one more entry."""
    if isinstance(entry, AcceptedUpdate):
        return snapshot.after(entry.update, reader).searched(entry.horizon, reader.program)
    return entry.snapshot if isinstance(entry, Checkpoint) else snapshot


def entry_to_message(entry: Entry) -> Message:
    """Return ``entry`` as a plain value that JSON knows."""
    if isinstance(entry, AcceptedUpdate):
        text = None if entry.update is None else str(entry.update)
        return {"do": "update", "update": text, "horizon": entry.horizon, "predicted": entry.predicted}
    if isinstance(entry, AdoptedPlan):
        actions, horizon, shortest = entry.plan
        return {"do": "adopt", "actions": symbols_to_text(sorted(actions)), "horizon": horizon, "shortest": shortest}
    return {"do": "checkpoint", "snapshot": entry.message}


def entry_from_message(message: Message) -> Entry:
    """Return the entry of :func:`entry_to_message`."""
    do = message["do"]
    if do == "update":
        text = message["update"]
        return AcceptedUpdate(None if text is None else parse_update(text), message["horizon"], message["predicted"])
    if do == "adopt":
        return AdoptedPlan(Plan(symbols_from_text(message["actions"]), message["horizon"], message["shortest"]))
    return Checkpoint(message=message["snapshot"])


def entry_to_line(entry: Entry) -> str:
    """Return ``entry`` as a line of JSON."""
    return _line(entry_to_message(entry))


def key_after(before: bytes, message: Message) -> bytes:
    """Return the key of a log of which the last entry is ``message`` and the one before has the key ``before``."""
    rest = b"" if message["do"] == "checkpoint" else before
    return hashlib.sha256(rest + _line(message).encode("ascii")).digest()


def _line(message: Message) -> str:
    return json.dumps(message, separators=(",", ":")) + "\n"
