"""The history of a stream: a list of accepted updates, adopted plans and checkpoints.

The history is the only state of a solver. A solver undoes an update by continuing from a shorter history. Workers, the
journal and replay read the same list.
"""

from dataclasses import dataclass
from hashlib import blake2b
from typing import FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Tuple, Union

import clingo

from rosoclingo.oclingo.program.action_rules import ACTION, dated_actions
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.progression.updates import Expire, Reset, StreamUpdate, Withdraw
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.text import (
    Message,
    snapshot_from_message,
    snapshot_to_message,
    symbols_from_text,
    symbols_to_text,
)


class Plan(NamedTuple):
    """The actions of an answer; later searches start from them.

    Attributes:
        actions: the ``_action_lib`` atoms.
        horizon: the horizon of the answer.
        shortest: whether all shorter horizons were refuted and no plan of this horizon costs less.

    """

    actions: FrozenSet[clingo.Symbol]
    horizon: int
    shortest: bool = False

    @classmethod
    def from_atoms(cls, atoms: Iterable[clingo.Symbol], horizon: int, shortest: bool = False) -> "Plan":
        """Return the plan in the shown ``atoms`` of an answer; other symbols are ignored."""
        return cls(dated_actions(atoms), horizon, shortest)

    @classmethod
    def from_result(cls, result: SolveResult) -> "Optional[Plan]":
        """Return the plan in the last answer, None if there is no answer."""
        return cls.from_atoms(result.answers[-1], result.horizon, result.shortest) if result.answers else None

    def rest(self, cycle: int) -> "Plan":
        """Return the plan with the actions from ``cycle`` on."""
        return self._replace(actions=frozenset(one for one in self.actions if cycle_of(one) >= cycle))

    def delayed(self) -> "Plan":
        """Return the plan delayed by one cycle, for example to repeat a failed action."""
        return Plan(frozenset(delay(one, 1) for one in self.actions), self.horizon + 1)

    def waiting_for(self, running: Iterable[clingo.Symbol], cycle: int) -> "Plan":
        """Return the plan from ``cycle`` on, in which ``running`` actions go on and delay all others."""
        rest = self.rest(cycle).delayed()
        return rest._replace(actions=rest.actions.union(going_on(running, cycle)))

    def fixing(self, actions: Iterable[clingo.Symbol]) -> List[Tuple[clingo.Symbol, bool]]:
        """Return assumptions about ``actions``: true if the plan contains the action, otherwise false."""
        return [(action, action in self.actions) for action in actions]

    def excluding_others(self, actions: Iterable[clingo.Symbol], late: int) -> List[Tuple[clingo.Symbol, bool]]:
        """Return assumptions that exclude ``actions``, except those of the plan and up to ``late`` cycles later."""
        allowed = {delay(action, cycles) for action in self.actions for cycles in range(late + 1)}
        return [(action, False) for action in actions if action not in allowed]

    @property
    def last_cycle(self) -> int:
        """The cycle of the last action; a very small number if the plan is empty."""
        return max(map(cycle_of, self.actions), default=-(2**31))


def going_on(running: Iterable[clingo.Symbol], cycle: int) -> FrozenSet[clingo.Symbol]:
    """Return the actions of ``cycle`` that go on: ``running`` are the ``_running`` atoms of the cycle before."""
    return frozenset(clingo.Function(ACTION.name, [*one.arguments[:2], clingo.Number(cycle)]) for one in running)


def robots_of(name: clingo.Symbol) -> Sequence[clingo.Symbol]:
    """Return the robots of an interface: the arguments of its name, as in ``move_base(r1)``, or else the name."""
    return (name.arguments if name.type is clingo.SymbolType.Function else ()) or [name]


def cycle_of(action: clingo.Symbol) -> int:
    """Return the cycle of an action."""
    return int(action.arguments[2].number)


def delay(action: clingo.Symbol, cycles: int) -> clingo.Symbol:
    """Return ``action`` some ``cycles`` later."""
    return clingo.Function(action.name, [*action.arguments[:2], clingo.Number(cycle_of(action) + cycles)])


@dataclass(frozen=True)
class AcceptedUpdate:
    """An accepted update.

    Attributes:
        update: the update, None for a search without one.
        horizon: the horizon of the answer; without an answer, the last grounded step.
        answered: whether an answer is known. Otherwise, a later update can withdraw facts of past steps.

    """

    update: Optional[StreamUpdate]
    horizon: int
    answered: bool = False


@dataclass(frozen=True)
class AdoptedPlan:
    """An adopted plan, from which later searches start. It does not change the snapshot."""

    plan: Plan


@dataclass(frozen=True)
class Checkpoint:
    """The snapshot of all earlier entries, with their key, as a plain value for JSON; it replaces these entries."""

    message: Message


Entry = Union[AcceptedUpdate, AdoptedPlan, Checkpoint]


class History:
    """An immutable linked list of entries, from the last one to the earlier ones.

    Attributes:
        entry: the last entry; None for the empty history.
        before: the history without the last entry; None for the empty history, or if it was released.
        length: the number of updates since the last checkpoint.
        step: k, the step of the last update.
        horizon: N, the horizon at which the next search begins.
        keep_from: the first step that is not over.
        answered: whether an answer to the last update is known.
        plan: the plan in force, None for none.

    """

    __slots__ = ("_key", "_snapshot", "answered", "before", "entry", "horizon", "keep_from", "length", "plan", "step")

    def __init__(self, before: Optional["History"] = None, entry: Optional[Entry] = None) -> None:
        """Append ``entry`` to the history ``before``; without arguments the history is empty."""
        self.before, self.entry = before, entry
        self._snapshot: Optional[Snapshot] = None
        self._key: Optional[str] = None
        self.length: int = 0 if before is None else before.length + isinstance(entry, AcceptedUpdate)
        self.step: int = 1 if before is None else before.step
        self.horizon: int = 1 if before is None else before.horizon
        self.keep_from: int = 0 if before is None else before.keep_from
        self.answered: bool = before is not None and before.answered
        self.plan: Optional[Plan] = None if before is None else before.plan
        if isinstance(entry, AcceptedUpdate):
            self._advance(entry)
        elif isinstance(entry, AdoptedPlan):
            self.plan = entry.plan
        elif isinstance(entry, Checkpoint):
            self.length, message = 0, entry.message
            self.step, self.horizon, self.keep_from = message["step"], message["horizon"], message["keep_from"]
            if before is not None:
                before._path()[0].before = None  # release all entries before the last checkpoint but one

    def _advance(self, entry: AcceptedUpdate) -> None:
        self.horizon, self.answered = entry.horizon, entry.answered
        if entry.update is not None:
            if Reset() in entry.update.items:
                self.step, self.keep_from = 1, 0
            self.step = self.step if entry.update.step is None else entry.update.step
            self.keep_from = max([self.keep_from, *(one.step for one in entry.update.items if isinstance(one, Expire))])

    # ---- Contents ----------------------------------------------------------------------------------------------------

    def snapshot(self, program: ReactiveProgram) -> Snapshot:
        """Return the snapshot of this history; this and all earlier histories cache theirs."""
        if self._snapshot is not None:
            return self._snapshot
        snapshot = Snapshot.initial(program)
        for history in self._path():
            snapshot = history._snapshot = history._snapshot or fold(snapshot, history.entry, program)
        return snapshot

    @property
    def entries(self) -> List[Entry]:
        """The last checkpoint, if any, and all later entries; they determine the snapshot and the plan."""
        return [history.entry for history in self._path() if history.entry is not None]

    def entries_after(self, other: "History") -> Optional[List[Entry]]:
        """Return the entries after ``other``; None if this history does not continue from it."""
        entries: List[Entry] = []
        history: Optional[History] = self
        while history is not other:
            if history is None or history.entry is None:
                return None
            entries.append(history.entry)
            history = history.before
        return entries[::-1]

    @property
    def key(self) -> str:
        """A hash of all updates since the start; it identifies the stream in all processes."""
        path, history = [], self  # type: List[History], Optional[History]
        while history is not None and history._key is None:
            path.append(history)
            history = history.before
        key = "" if history is None or history._key is None else history._key
        for one in reversed(path):
            if isinstance(one.entry, AcceptedUpdate):
                text = f"{key} {one.entry.horizon} {one.entry.update}"
                key = blake2b(text.encode(), digest_size=16).hexdigest()
            elif isinstance(one.entry, Checkpoint):
                key = one.entry.message["key"]
            one._key = key
        return key

    def _path(self) -> List["History"]:
        """Return the histories from the last checkpoint to this one."""
        path = [self]
        while path[-1].before is not None and not isinstance(path[-1].entry, Checkpoint):
            path.append(path[-1].before)
        return path[::-1]

    # ---- The last update ---------------------------------------------------------------------------------------------

    @property
    def update(self) -> Optional[StreamUpdate]:
        """The last update, None if there is none."""
        last = self._last_update
        return None if last is None else last[1].update

    @property
    def before_update(self) -> Optional["History"]:
        """The history before the last update, None if there is none or it was released."""
        last = self._last_update
        return None if last is None else last[0].before

    @property
    def _last_update(self) -> Optional[Tuple["History", AcceptedUpdate]]:
        """The history up to the last update, and its entry."""
        history: Optional[History] = self
        while history is not None:
            if isinstance(history.entry, AcceptedUpdate) and history.entry.update is not None:
                return history, history.entry
            history = history.before
        return None

    # ---- Longer and shorter histories --------------------------------------------------------------------------------

    def with_entries(self, *entries: Entry) -> "History":
        """Return the history with further entries."""
        history = self
        for entry in entries:
            history = History(history, entry)
        return history

    def withdraw(self, facts: FrozenSet[clingo.Symbol]) -> "History":
        """Return the history with an update that withdraws ``facts``; withdrawn actions count as not executed."""
        update = StreamUpdate(items=tuple(map(Withdraw, sorted(facts))))
        return self.with_entries(AcceptedUpdate(update, self.horizon)) if facts else self

    def adopt(self, plan: Optional[Plan]) -> "History":
        """Return the history with ``plan`` in force; the same history if ``plan`` is in force already or None."""
        return self if plan is None or plan == self.plan else self.with_entries(AdoptedPlan(plan))

    def checkpoint(self, snapshot: Snapshot) -> "History":
        """Return the history with a checkpoint of its ``snapshot`` or an equivalent one; the plan stays in force."""
        history = self.with_entries(Checkpoint({**snapshot_to_message(snapshot), "key": self.key}))
        history._snapshot = snapshot
        return history if self.plan is None else history.with_entries(AdoptedPlan(self.plan))


def fold(snapshot: Snapshot, entry: Optional[Entry], program: ReactiveProgram) -> Snapshot:
    """Return the snapshot after one more entry."""
    if isinstance(entry, AcceptedUpdate):
        return snapshot.with_update(entry.update, program).with_horizon(entry.horizon, program)
    return snapshot_from_message(entry.message) if isinstance(entry, Checkpoint) else snapshot


def entry_to_message(entry: Entry) -> Message:
    """Return ``entry`` as a plain value for JSON."""
    if isinstance(entry, AcceptedUpdate):
        text = None if entry.update is None else str(entry.update)
        return {"do": "update", "update": text, "horizon": entry.horizon, "answered": entry.answered}
    if isinstance(entry, AdoptedPlan):
        actions, horizon, shortest = entry.plan
        return {"do": "adopt", "actions": symbols_to_text(sorted(actions)), "horizon": horizon, "shortest": shortest}
    return {"do": "checkpoint", "snapshot": entry.message}


def entry_from_message(message: Message) -> Entry:
    """Return the entry from the value of :func:`entry_to_message`."""
    do = message["do"]
    if do == "update":
        text = message["update"]
        update = None if text is None else parse_update(text)
        return AcceptedUpdate(update, message["horizon"], message.get("answered", False))
    if do == "adopt":
        return AdoptedPlan(Plan(symbols_from_text(message["actions"]), message["horizon"], message["shortest"]))
    return Checkpoint(message["snapshot"])
