"""Snapshots: the state of a stream between two updates, computed from the history without clingo."""

from dataclasses import dataclass, field, replace
from typing import Callable, Dict, FrozenSet, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Set, Tuple, Union

import clingo

from rosoclingo.oclingo.program.action_rules import FAILED, RETURN
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.update_reader import closed_cycles, with_failures, with_their_failures
from rosoclingo.oclingo.progression.lifetimes import FOREVER, UPDATE, Lifetime, Term, lifetime_of
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import (
    Anew,
    Assert,
    Cumulative,
    Forget,
    Over,
    Retract,
    Section,
    Statement,
    StreamUpdate,
    Volatile,
)
from rosoclingo.oclingo.solving.results import NOT_EXTERNAL

_NUMBER = clingo.SymbolType.Number


class TimedStatement(NamedTuple):
    """A statement with its lifetime and the number of its update.

    The number is 0 for statements asserted before the step that declares their head: all of these define the head.
    """

    statement: Statement
    lifetime: Lifetime
    update: int


class ForgottenSteps(NamedTuple):
    """Externals of the steps ``first`` to ``last`` that no earlier statement defines are false for good.

    Not so the heads ``spared``, which statements that lapse define.
    """

    first: int
    last: int
    spared: FrozenSet[clingo.Symbol] = frozenset()


class ClosedHeads(NamedTuple):
    """Atoms of compacted steps that no later statement can define."""

    atoms: FrozenSet[clingo.Symbol]


SnapshotItem = Union[TimedStatement, ForgottenSteps, ClosedHeads]


@dataclass(frozen=True)
class Past:
    """The compacted steps of a stream, which are no longer ground (see :mod:`~rosoclingo.planning.compaction`).

    Attributes:
        first: the first step that is still ground.
        facts: the true atoms of compacted steps that later steps can depend on.
        shown: the shown atoms of compacted steps, each with its step.

    """

    first: int
    facts: FrozenSet[clingo.Symbol]
    shown: Tuple[Tuple[int, clingo.Symbol], ...] = ()


@dataclass(frozen=True)
class Snapshot:
    """The state of a stream between two updates.

    Attributes:
        step: k, the step of the last update.
        horizon: N, the last step that was searched.
        bound: B, the greatest horizon to search, None for no bound.
        min_horizon: the least horizon to search: the greatest step of all updates.
        number: the number of updates so far.
        items: statements, ``#forget`` and closed heads in order, also statements whose head is not declared external.
        closed: the actions that were executed in each closed cycle.
        keep_from: steps before it can be compacted.
        past: the compacted steps, None for none.
        warnings: warnings about ignored items of the last update; not compared.

    """

    step: int = 1
    horizon: int = 1
    bound: Optional[int] = None
    min_horizon: int = 1
    number: int = 0
    items: Tuple[SnapshotItem, ...] = ()
    closed: Mapping[int, FrozenSet[clingo.Symbol]] = field(default_factory=dict)
    keep_from: int = 0
    past: Optional[Past] = None
    warnings: Tuple[str, ...] = field(default=(), compare=False)

    @classmethod
    def initial(cls, program: ReactiveProgram) -> "Snapshot":
        """Return the snapshot of an empty history."""
        return cls(items=tuple(_forgotten(program, program.first_step, 1)))

    # ---- Queries -----------------------------------------------------------------------------------------------------

    @property
    def timed_statements(self) -> Iterator[TimedStatement]:
        """The statements with their lifetimes."""
        return (one for one in self.items if isinstance(one, TimedStatement))

    @property
    def permanent(self) -> Iterator[Statement]:
        """The statements that never lapse."""
        return (one.statement for one in self.timed_statements if one.lifetime == FOREVER)

    @property
    def lapsing(self) -> Iterator[Statement]:
        """The statements that can lapse."""
        return (one.statement for one in self.timed_statements if one.lifetime != FOREVER)

    @property
    def statements(self) -> Iterator[Statement]:
        """All statements."""
        return (one.statement for one in self.timed_statements)

    @property
    def size(self) -> int:
        """Approximate number of values."""
        return len(self.items) + sum(len(one.atoms) for one in self.items if isinstance(one, ClosedHeads))

    @property
    def is_steady(self) -> bool:
        """Whether no statement lapses with the next update."""
        return all(one.lifetime != UPDATE for one in self.timed_statements)

    @property
    def awaiting_returns(self) -> FrozenSet[int]:
        """The closed cycles whose returns can still arrive: the last one, and the last one with actions."""
        done = (cycle for cycle, executed in self.closed.items() if executed)
        return frozenset({max(self.closed), max(done, default=max(self.closed))}) if self.closed else frozenset()

    def permanent_facts(self, assumable: FrozenSet[clingo.Symbol]) -> Set[clingo.Symbol]:
        """Return the facts that never lapse, except ``assumable`` ones.

        The first update that permanently defines a head closes it: later statements are ignored.
        """
        closing: Dict[clingo.Symbol, int] = {}
        facts: Set[clingo.Symbol] = set()
        for statement, lifetime, number in self.timed_statements:
            if statement.head is None or lifetime != FOREVER:
                continue
            if closing.setdefault(statement.head, number) == number and not statement.body:
                facts.add(statement.head)
        return facts - with_their_failures(assumable)

    def closed_until(self, first: int) -> int:
        """Return the last step such that all cycles from ``first`` on are closed; ``first - 1`` if there is none."""
        last = first - 1
        while last + 1 in self.closed:
            last += 1
        return last

    def is_too_late(self, program: ReactiveProgram, atom: clingo.Symbol) -> bool:
        """Return whether only compacted steps could have depended on ``atom``, which was not asserted so far."""
        if self.past is None:
            return False
        last = self.past.first - 1
        if program.may_declare(atom, program.first_step, last):
            return not program.may_declare(atom, last + 1)
        was_visible = program.is_open_signature(atom) and program.may_see([atom], program.first_step, last)
        return was_visible and not program.may_mention(atom, last + 1)

    def mentions_later_steps(self, program: ReactiveProgram) -> bool:
        """Return whether a statement with a head can concern steps after the present one."""
        rules = (one for one in self.statements if one.head is not None)
        return any(program.may_mention(atom, self.step + 1) for one in rules for atom in one.atoms)

    # ---- Changes -----------------------------------------------------------------------------------------------------

    def with_update(self, update: Optional[StreamUpdate], program: ReactiveProgram) -> "Snapshot":
        """Return the snapshot after ``update``, with a horizon of at least its step."""
        if update is None:
            return replace(self, number=self.number + 1, warnings=())  # they are reported once
        number = self.number + 1
        update = with_failures(program, update, self.permanent)
        start = Snapshot.initial(program) if Anew() in update.items else self
        start = start._close_cycles(update, program).without_facts(update.withdrawn)
        step, bound = start.step, start.bound
        if update.step is not None:
            step, bound = update.step, None if update.bound is None else update.step + update.bound
        min_horizon, horizon = max(start.min_horizon, step), max(start.horizon, step)
        kept = [one for one in start.items if not _lapses(one, min_horizon)]
        timely, late_warnings = start._without_late_returns(update)

        def number_of(statement: Statement) -> int:
            is_early = statement.head is not None and program.is_declared_after(statement.head, horizon)
            return 0 if is_early else number

        items, warnings = _with_statements(kept, timely, step, min_horizon, number_of)
        requested = [
            ForgottenSteps(one.first, min(one.last, horizon))
            for one in update.items
            if isinstance(one, Forget) and one.first <= horizon
        ]
        forgotten = _forgotten(program, start.horizon + 1, horizon, items, requested)
        return replace(
            start,
            step=step,
            horizon=horizon,
            bound=bound,
            min_horizon=min_horizon,
            number=number,
            items=(*items, *forgotten),
            warnings=warnings + late_warnings,
        )

    def with_horizon(self, horizon: int, program: ReactiveProgram) -> "Snapshot":
        """Return the snapshot after a search up to ``horizon``."""
        forgotten = _forgotten(program, self.horizon + 1, horizon, self.items)
        return replace(self, horizon=horizon, items=(*self.items, *forgotten))

    def with_least_horizon(self) -> "Snapshot":
        """Return the snapshot with the least horizon that includes all steps mentioned in statements.

        The snapshot is unchanged if a statement can lapse or steps were forgotten.
        """
        if any(not isinstance(one, TimedStatement) or one.lifetime not in (FOREVER, UPDATE) for one in self.items):
            return self
        atoms = (atom for one in self.statements for atom in one.atoms)
        numbers = [value.number for atom in atoms for value in atom.arguments if value.type is _NUMBER]
        return replace(self, horizon=min(self.horizon, max([self.step, self.min_horizon, *numbers])))

    def without_facts(self, facts: FrozenSet[clingo.Symbol]) -> "Snapshot":
        """Return the snapshot as if ``facts`` had not been asserted; an action among them was not executed.

        Their consequences in compacted steps remain.
        """
        if not facts:
            return self
        facts = with_their_failures(facts)
        past = self.past if self.past is None else replace(self.past, facts=self.past.facts - facts)
        items = tuple(
            one for one in self.items if not (isinstance(one, TimedStatement) and one.statement.concerns(facts))
        )
        closed = {cycle: executed - facts for cycle, executed in self.closed.items()}
        return replace(self, past=past, items=items, closed=closed)

    def _without_late_returns(self, update: StreamUpdate) -> Tuple[StreamUpdate, Tuple[str, ...]]:
        """Drop returns that can no longer arrive from ``update``; return the rest and the warnings."""
        closed = {clingo.Number(cycle) for cycle in self.closed.keys() - self.awaiting_returns}
        heads = {one for one in update.heads if one is not None and signature_of(one) in (RETURN, FAILED)}
        late = {one for one in heads if one.arguments[2] in closed}
        if not late:
            return update, ()
        items = tuple(one for one in update.items if not (isinstance(one, Statement) and one.head in late))
        known = {one.head for one in self.statements if not one.body} | (self.past.facts if self.past else set())
        return replace(update, items=items), tuple(NOT_EXTERNAL.format(one) for one in sorted(late - known))

    def _close_cycles(self, update: StreamUpdate, program: ReactiveProgram) -> "Snapshot":
        """Return the snapshot with the cycles and steps that ``update`` declares closed or over."""
        closed = {**self.closed, **closed_cycles(update, program.first_step, self.step)}
        over = (item.step for item in update.items if isinstance(item, Over))
        return replace(self, closed=closed, keep_from=max([self.keep_from, *over]))


def _lapses(item: SnapshotItem, min_horizon: int) -> bool:
    """Return whether ``item`` lapses with an update after which ``min_horizon`` is the least horizon."""
    return isinstance(item, TimedStatement) and (item.lifetime == UPDATE or _has_passed(item.lifetime, min_horizon))


def _has_passed(lifetime: Lifetime, min_horizon: int) -> bool:
    return isinstance(lifetime, int) and lifetime < min_horizon


def _with_statements(
    kept: List[SnapshotItem],
    update: StreamUpdate,
    step: int,
    min_horizon: int,
    number_of: Callable[[Statement], int],
) -> Tuple[List[SnapshotItem], Tuple[str, ...]]:
    """Apply the assertions and retractions of ``update`` to ``kept``; return the items and the warnings."""
    items, warnings = list(kept), []
    section: Section = Cumulative()
    for item in update.items:
        if isinstance(item, Statement):
            lifetime = lifetime_of(section, step)
            if not (_has_passed(lifetime, min_horizon) or item.is_tautology):
                items.append(TimedStatement(item, lifetime, number_of(item)))
        elif isinstance(item, Retract):
            rest = [one for one in items if not (isinstance(one, TimedStatement) and one.lifetime == Term(item.term))]
            if len(rest) == len(items):
                warnings.append(f"Term {item.term} has not been asserted. The retraction is ignored.")
            items = rest
        elif isinstance(item, (Cumulative, Volatile, Assert)):
            section = item
    return items, tuple(warnings)


def _forgotten(
    program: ReactiveProgram,
    first: int,
    last: int,
    items: Iterable[SnapshotItem] = (),
    requested: Iterable[ForgottenSteps] = (),
) -> List[ForgottenSteps]:
    """Return the steps that the program forgets when it grounds the steps ``first`` to ``last``, and those requested.

    The heads that lapsing statements in ``items`` define are spared.
    """
    forgotten = list(requested)
    for at in range(first, last + 1) if program.forgets else ():
        forgotten += [ForgottenSteps(step, step) for step in program.forgotten_at(at) if step < at]
    if not forgotten:
        return []
    lapsing = (one.statement.head for one in items if isinstance(one, TimedStatement) and one.lifetime != FOREVER)
    spared = frozenset(head for head in lapsing if head is not None)
    return [one._replace(spared=spared) for one in forgotten]
