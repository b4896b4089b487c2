"""What is in force at a point of a stream: a value that follows from the history alone, without clingo."""

from dataclasses import dataclass, field, replace
from typing import Callable, Dict, FrozenSet, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Set, Tuple, Union

import clingo

from rosoclingo.oclingo.program.action_rules import FAILED, RETURN, is_action_of
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.update_reader import Reader, with_their_failures
from rosoclingo.oclingo.progression.lifetimes import FOREVER, UPDATE, Lifetime, Term, lifetime_of
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import (
    Anew,
    Assert,
    Closed,
    Cumulative,
    Forget,
    Over,
    Retract,
    Section,
    Statement,
    StreamUpdate,
    Volatile,
)

_NUMBER = clingo.SymbolType.Number

NOT_EXTERNAL = "Head {} has not been declared external. The entire rule will be ignored."


class TimedStatement(NamedTuple):
    """A statement with its lifetime, and the number of the update that brought it.

    The number is 0 for statements that came before the step that declares their head: these define it together.
    """

    statement: Statement
    lifetime: Lifetime
    update: int


class ForgottenSteps(NamedTuple):
    """Externals that steps ``first`` to ``last`` declare and no statement before defines are false for good.

    The heads ``spared`` were defined then by statements that lapse.
    """

    first: int
    last: int
    spared: FrozenSet[clingo.Symbol] = frozenset()


class ClosedHeads(NamedTuple):
    """Atoms that no later statement defines; retired steps have decided them."""

    atoms: FrozenSet[clingo.Symbol]


Fact = Union[TimedStatement, ForgottenSteps, ClosedHeads]


@dataclass(frozen=True)
class Past:
    """The steps of a stream that are over and no longer ground (see :mod:`~rosoclingo.planning.compaction`).

    Attributes:
        first: the first step that is still ground.
        facts: what later steps may see of what those before define.
        shown: what answers show of those steps, each with its step.

    """

    first: int
    facts: FrozenSet[clingo.Symbol]
    shown: Tuple[Tuple[int, clingo.Symbol], ...] = ()


@dataclass(frozen=True)
class Snapshot:
    """What is in force between two updates.

    Attributes:
        step: k, the step of the last update.
        horizon: N, the last step that was searched.
        bound: B, the greatest horizon to search, None for no bound.
        settled: the greatest step of all updates: no horizon before it is asked for.
        number: the number of updates so far.
        told: statements, ``#forget`` and closed heads, in order. Whether a head is declared external is not known here.
        closed: the actions that were executed in each closed cycle.
        keep_from: steps before it may be retired.
        past: the steps that have been retired, None for none.
        odd: what was ignored of the last update; no part of the value.

    """

    step: int = 1
    horizon: int = 1
    bound: Optional[int] = None
    settled: int = 1
    number: int = 0
    told: Tuple[Fact, ...] = ()
    closed: Mapping[int, FrozenSet[clingo.Symbol]] = field(default_factory=dict)
    keep_from: int = 0
    past: Optional[Past] = None
    odd: Tuple[str, ...] = field(default=(), compare=False)

    @classmethod
    def first(cls, program: ReactiveProgram) -> "Snapshot":
        """Return the snapshot of a stream that begins."""
        return cls(told=tuple(_forgotten_by(program, program.first_step, 1)))

    # ---- What it says ------------------------------------------------------------------------------------------------

    @property
    def entries(self) -> Iterator[TimedStatement]:
        """The statements with their lifetimes."""
        return (one for one in self.told if isinstance(one, TimedStatement))

    @property
    def permanent(self) -> Iterator[Statement]:
        """The statements that hold for ever."""
        return (one.statement for one in self.entries if one.lifetime == FOREVER)

    @property
    def lapsing(self) -> Iterator[Statement]:
        """The statements that will lapse."""
        return (one.statement for one in self.entries if one.lifetime != FOREVER)

    @property
    def statements(self) -> Iterator[Statement]:
        """All statements."""
        return (one.statement for one in self.entries)

    @property
    def size(self) -> int:
        """About how many values it consists of."""
        return len(self.told) + sum(len(one.atoms) for one in self.told if isinstance(one, ClosedHeads))

    @property
    def is_steady(self) -> bool:
        """Whether nothing lapses with the next update."""
        return all(one.lifetime != UPDATE for one in self.entries)

    @property
    def returning(self) -> FrozenSet[int]:
        """The closed cycles whose returns can still arrive: the last one, and the last one with actions."""
        done = (cycle for cycle, executed in self.closed.items() if executed)
        return frozenset({max(self.closed), max(done, default=max(self.closed))}) if self.closed else frozenset()

    def facts_without(self, assumable: FrozenSet[clingo.Symbol]) -> Set[clingo.Symbol]:
        """Return what is a fact for good, less what is ``assumable``.

        The first update that defines a head for good closes it.
        """
        closing: Dict[clingo.Symbol, int] = {}
        facts: Set[clingo.Symbol] = set()
        for statement, lifetime, number in self.entries:
            if statement.head is None or lifetime != FOREVER:
                continue
            if closing.setdefault(statement.head, number) == number and not statement.body:
                facts.add(statement.head)
        return facts - with_their_failures(assumable)

    def closed_until(self, first: int) -> int:
        """Return the last step from ``first`` on up to which all cycles are closed, the one before if none is."""
        last = first - 1
        while last + 1 in self.closed:
            last += 1
        return last

    def first_ground(self, program: ReactiveProgram) -> int:
        """Return the first step that is ground."""
        return program.first_step if self.past is None else self.past.first

    def is_too_late(self, program: ReactiveProgram, atom: clingo.Symbol) -> bool:
        """Whether only retired steps could have known of ``atom``, which nobody has told yet."""
        if self.past is None:
            return False
        last = self.past.first - 1
        if program.may_declare(atom, program.first_step, last):
            return not program.may_declare(atom, last + 1)
        known = program.is_open_signature(atom) and program.may_see([atom], program.first_step, last)
        return known and not program.may_mention(atom, last + 1)

    def tells_of_later(self, program: ReactiveProgram) -> bool:
        """Whether a statement with a head may concern steps after the present one."""
        told = (one for one in self.statements if one.head is not None)
        return any(program.may_mention(atom, self.step + 1) for one in told for atom in one.atoms)

    # ---- What follows it ---------------------------------------------------------------------------------------------

    def after(self, update: Optional[StreamUpdate], reader: Reader) -> "Snapshot":
        """Return the snapshot with ``update``, up to whose step there is a horizon."""
        if update is None:
            return replace(self, number=self.number + 1, odd=())  # what was ignored before is told once
        program = reader.program
        update = reader.read(update, self.permanent)
        found = Snapshot.first(program) if Anew() in update.items else self
        found = found._look_back(update, program).without(update.withdrawn)
        step = found.step if update.step is None else update.step
        bound = found.bound
        if update.step is not None:
            bound = None if update.bound is None else step + update.bound
        settled = found.settled if update.step is None else max(found.settled, step)
        horizon = max(found.horizon, step)
        number = self.number + 1
        kept = [one for one in found.told if not _lapses(one, settled)]
        timely, late = found._without_late_returns(update)

        def number_of(statement: Statement) -> int:
            early = statement.head is not None and program.is_declared_after(statement.head, horizon)
            return 0 if early else number

        told, odd = _taken(kept, timely, step, settled, number_of)
        due = _forgotten_by(program, found.horizon + 1, horizon)
        due += [
            ForgottenSteps(one.first, min(one.last, horizon))
            for one in update.items
            if isinstance(one, Forget) and one.first <= horizon
        ]
        told += _sparing(due, told)
        return replace(
            found,
            step=step,
            horizon=horizon,
            bound=bound,
            settled=settled,
            number=number,
            told=tuple(told),
            odd=odd + late,
        )

    def searched(self, horizon: int, program: ReactiveProgram) -> "Snapshot":
        """Return the snapshot after a search up to ``horizon``."""
        forgotten = _sparing(_forgotten_by(program, self.horizon + 1, horizon), self.told)
        return replace(self, horizon=horizon, told=(*self.told, *forgotten)) if horizon != self.horizon else self

    def without(self, facts: FrozenSet[clingo.Symbol]) -> "Snapshot":
        """Return the snapshot that would be, had none of ``facts`` been told; an action in it was not executed.

        What has followed from them in retired steps stays.
        """
        if not facts:
            return self
        facts = with_their_failures(facts)
        past = self.past if self.past is None else replace(self.past, facts=self.past.facts - facts)
        told = tuple(
            one for one in self.told if not (isinstance(one, TimedStatement) and one.statement.concerns(facts))
        )
        closed = {cycle: executed - facts for cycle, executed in self.closed.items()}
        return replace(self, past=past, told=told, closed=closed)

    def shortened(self) -> "Snapshot":
        """Return the snapshot with the horizon at which all steps are ground of which something was told.

        The same if something lapses or was forgotten by then.
        """
        if any(not isinstance(one, TimedStatement) or one.lifetime not in (FOREVER, UPDATE) for one in self.told):
            return self
        atoms = (atom for one in self.statements for atom in one.atoms)
        told = [value.number for atom in atoms for value in atom.arguments if value.type is _NUMBER]
        return replace(self, horizon=min(self.horizon, max([self.step, self.settled, *told])))

    def _without_late_returns(self, update: StreamUpdate) -> Tuple[StreamUpdate, Tuple[str, ...]]:
        """Return the update without returns of cycles whose returns are closed, and the warnings about these."""
        closed = {clingo.Number(cycle) for cycle in self.closed.keys() - self.returning}
        heads = {one for one in update.heads if one is not None and signature_of(one) in (RETURN, FAILED)}
        late = {one for one in heads if one.arguments[2] in closed}
        if not late:
            return update, ()
        items = tuple(one for one in update.items if not (isinstance(one, Statement) and one.head in late))
        known = {one.head for one in self.statements if not one.body} | (self.past.facts if self.past else set())
        return replace(update, items=items), tuple(NOT_EXTERNAL.format(one) for one in sorted(late - known))

    def _look_back(self, update: StreamUpdate, program: ReactiveProgram) -> "Snapshot":
        """Return the snapshot with what an update says of the past."""
        closed, keep_from = dict(self.closed), self.keep_from
        for item in update.items:
            if isinstance(item, Closed):
                last = self.step if update.step is None else update.step
                for cycle in range(max(item.first, program.first_step), min(item.last, last) + 1):
                    closed[cycle] = frozenset(filter(is_action_of(cycle), update.committed))
            elif isinstance(item, Over):
                keep_from = max(keep_from, item.step)
        return replace(self, closed=closed, keep_from=keep_from)


def _lapses(one: Fact, settled: int) -> bool:
    """Whether a statement holds at no horizon from ``settled`` on, once there is another update."""
    return isinstance(one, TimedStatement) and (one.lifetime == UPDATE or _has_passed(one.lifetime, settled))


def _has_passed(lifetime: Lifetime, settled: int) -> bool:
    return isinstance(lifetime, int) and lifetime < settled


def _taken(
    kept: List[Fact], update: StreamUpdate, step: int, settled: int, number_of: Callable[[Statement], int]
) -> Tuple[List[Fact], Tuple[str, ...]]:
    """Return the statements ``kept`` and those of the update, and what was ignored."""
    told, odd = list(kept), []
    section: Section = Cumulative()
    for item in update.items:
        if isinstance(item, Statement):
            lifetime = lifetime_of(section, step)
            if not (_has_passed(lifetime, settled) or item.is_tautology):
                told.append(TimedStatement(item, lifetime, number_of(item)))
        elif isinstance(item, Retract):
            less = [one for one in told if not (isinstance(one, TimedStatement) and one.lifetime == Term(item.term))]
            if len(less) == len(told):
                odd.append(f"Term {item.term} has not been asserted. The retraction is ignored.")
            told = less
        elif isinstance(item, (Cumulative, Volatile, Assert)):
            section = item
    return told, tuple(odd)


def _sparing(forgotten: List[ForgottenSteps], told: Iterable[Fact]) -> List[ForgottenSteps]:
    """Return what is ``forgotten`` after the statements ``told``."""
    if not forgotten:
        return []
    lapsing = (one.statement.head for one in told if isinstance(one, TimedStatement) and one.lifetime != FOREVER)
    spared = frozenset(head for head in lapsing if head is not None)
    return [one._replace(spared=spared) for one in forgotten]


def _forgotten_by(program: ReactiveProgram, first: int, last: int) -> List[ForgottenSteps]:
    """Return what the program itself forgets when steps ``first`` to ``last`` are ground."""
    if not program.forgets:
        return []
    found = ((step, at) for at in range(first, last + 1) for step in program.forgotten_at(at))
    return [
        ForgottenSteps(step, step) for step, at in found if step < at
    ]  # what a step declares itself it cannot forget
