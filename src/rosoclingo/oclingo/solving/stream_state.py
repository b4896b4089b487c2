"""What the solver knows of its stream: enough to build the grounding anew at any time; and how it reads updates.

Beside a return that is no success it reads ``_failed(A,V,C)``, for programs that declare it. Success is the parameter
of an action that was committed, anything else is a reason. A program could say so itself,

    failed(A,V,t) :- _return(A,V,t), not _action_lib(A,V,t).

but would be ground for every value that may come; ``_failed/3`` comes when something has failed, and costs nothing
before. Where nothing was committed for the cycle, it comes with each return: the rule above still tells.
"""

from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Dict, FrozenSet, Iterable, Iterator, List, Optional, Set, Tuple, Union

import clingo

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.action_rules import FAILED, RETURN, is_action
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.strings import strings_apart
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import (
    Assert,
    Closed,
    Cumulative,
    Item,
    Over,
    Section,
    Statement,
    StreamUpdate,
    Volatile,
)


@dataclass(frozen=True)
class Term:
    """Lifetime of asserted statements: until ``term`` is retracted."""

    term: clingo.Symbol


_NUMBER = clingo.SymbolType.Number

FOREVER, UPDATE = "forever", "update"
Lifetime = Union[str, int, Term]
"""FOREVER, UPDATE (until the next update), the last horizon at which a statement holds, or a Term."""


def lifetime_of(section: Section, step: int) -> Lifetime:
    """Return how long a statement of ``section`` holds in an update of step ``step``."""
    if isinstance(section, Cumulative):
        return FOREVER
    if isinstance(section, Assert):
        return Term(section.term)
    assert isinstance(section, Volatile)
    return step + section.window - 1 if section.window else UPDATE  # a window of 0 is none


@dataclass(frozen=True)
class Lapsing:
    """A statement that will lapse, or that waits until its head is declared.

    Attributes:
        statement: the rule.
        lifetime: how long it holds.

    """

    statement: Statement
    lifetime: Lifetime


@dataclass(frozen=True)
class Past:
    """The steps of a stream that are over and no longer ground (see :mod:`~rosoclingo.oclingo.solving.compaction`).

    Attributes:
        first: the first step that is still ground.
        facts: what later steps may see of what those before define.
        shown: what answers show of those steps, each with its step.

    """

    first: int
    facts: FrozenSet[clingo.Symbol]
    shown: Tuple[Tuple[int, clingo.Symbol], ...] = ()


@dataclass
class StreamState:
    """State of a stream between two updates.

    Attributes:
        step: k, the step of the last update.
        bound: B, the greatest horizon to search, None for no bound.
        horizon: N, the last grounded step.
        permanent: statements that hold for ever, in order.
        lapsing: statements in force that will lapse.
        waiting: statements whose head is an external that only a later step declares.
        open_atoms: atoms of open signatures seen so far, in order.
        forgotten: externals closed by ``#forget``.
        forgets_done: last step at which the program's own ``#forget`` was carried out.
        closed_cycles: the actions that were executed in each cycle that has been closed.
        keep_from: steps before it may be retired.
        past: the steps that have been retired, None for none.
        cyclic: True once a statement may close a positive loop over several steps; such a stream is ground anew for
            each search, since clingo looks for loops only among the rules that come between two searches.
        settled: the greatest step of all updates: a ``shortest`` solver looks for no horizon before it any more.
        tried: before which step it was tried last to retire steps.
        told: what has been remarked on the stream, each of which is told once.

    """

    step: int
    horizon: int
    bound: Optional[int] = None
    permanent: List[Statement] = field(default_factory=list)
    lapsing: List[Lapsing] = field(default_factory=list)
    waiting: List[Lapsing] = field(default_factory=list)
    open_atoms: List[clingo.Symbol] = field(default_factory=list)
    forgotten: Set[clingo.Symbol] = field(default_factory=set)
    forgets_done: int = 0
    closed_cycles: Dict[int, FrozenSet[clingo.Symbol]] = field(default_factory=dict)
    keep_from: int = 0
    past: Optional[Past] = None
    cyclic: bool = False
    settled: int = 1
    tried: int = 0
    told: Set[str] = field(default_factory=set)

    @property
    def size(self) -> int:
        """About how many values it consists of."""
        statements = len(self.permanent) + len(self.lapsing) + len(self.waiting)
        return statements + len(self.open_atoms) + len(self.forgotten)

    @property
    def is_steady(self) -> bool:
        """Whether the next update brings nothing by itself: nothing lapses with it, and the grounding stays."""
        return not self.cyclic and all(entry.lifetime != UPDATE for entry in [*self.lapsing, *self.waiting])

    def unsettled(self) -> Iterator[Statement]:
        """Yield the statements that will lapse, and those that wait for their heads."""
        for entry in [*self.lapsing, *self.waiting]:
            yield entry.statement

    def statements(self) -> Iterator[Statement]:
        """Yield all that was told and still matters, be it in force or waiting."""
        return chain(self.permanent, self.unsettled())

    def facts_without(self, doubted: FrozenSet[clingo.Symbol]) -> Set[clingo.Symbol]:
        """Return what is a fact for good, but what is ``doubted``."""
        facts = {one.head for one in self.permanent if one.head is not None and not one.body}
        return facts - with_their_failures(doubted)

    def rules(self) -> Iterator[Statement]:
        """Yield the statements in force that have a head and a body."""
        for statement in [*self.permanent, *(entry.statement for entry in self.lapsing)]:
            if statement.head is not None and statement.body:
                yield statement

    @property
    def returning(self) -> FrozenSet[int]:
        """The closed cycles whose returns can still arrive: the last one, and the last one with actions."""
        closed = self.closed_cycles
        done = (cycle for cycle, executed in closed.items() if executed)
        return frozenset({max(closed), max(done, default=max(closed))}) if closed else frozenset()

    def closed_until(self, first: int) -> int:
        """Return the last step from ``first`` on up to which all cycles are closed, the one before where none is.

        So where it is to be ground in one piece, too.
        """
        last = first - 1
        while last + 1 in self.closed_cycles and not self.cyclic:
            last += 1
        return last

    def copy(self) -> "StreamState":
        """Return a copy that shares nothing that changes."""
        return replace(
            self,
            permanent=list(self.permanent),
            lapsing=list(self.lapsing),
            waiting=list(self.waiting),
            open_atoms=list(self.open_atoms),
            forgotten=set(self.forgotten),
            closed_cycles=dict(self.closed_cycles),
            told=set(self.told),
        )

    def shortened(self) -> "StreamState":
        """Return a copy with a shorter horizon, at which the steps are ground of which something was told.

        The same where something lapses or was closed by then.
        """
        copy = self.copy()
        if not self.forgotten and all(entry.lifetime == UPDATE for entry in self.lapsing):
            atoms = [*self.open_atoms, *(atom for one in self.statements() for atom in one.atoms)]
            told = [value.number for atom in atoms for value in atom.arguments if value.type is _NUMBER]
            copy.horizon = min(self.horizon, max([self.step, *told]))
        return copy

    def less(self, facts: FrozenSet[clingo.Symbol]) -> "StreamState":
        """Return the state that would be, had none of ``facts`` been told; an action in it was not executed.

        What has followed from them in retired steps stays.
        """
        less, facts = self.copy(), with_their_failures(facts)
        if less.past is not None:
            less.past = replace(less.past, facts=less.past.facts - facts)
        less.permanent = [statement for statement in less.permanent if not statement.concerns(facts)]
        less.lapsing = [entry for entry in less.lapsing if not entry.statement.concerns(facts)]
        less.waiting = [entry for entry in less.waiting if not entry.statement.concerns(facts)]
        less.open_atoms = [atom for atom in less.open_atoms if atom not in facts]
        less.closed_cycles = {cycle: executed - facts for cycle, executed in less.closed_cycles.items()}
        return less


@dataclass(frozen=True)
class Setting:
    """What all transactions of a solver share.

    Attributes:
        program: the reactive logic program.
        horizon_limit: the last step that may be grounded, None for no limit.
        shortest: whether answers are searched from step k on (see ``ReactiveSolver``).
        oclingo_strings: whether strings in updates are taken as oClingo did.
        foresees: whether answers tell which returns are foreseen.

    """

    program: ReactiveProgram
    horizon_limit: Optional[int] = None
    shortest: bool = False
    oclingo_strings: bool = False
    foresees: bool = False

    def fresh_state(self) -> StreamState:
        """Return the state of a stream that begins."""
        return StreamState(step=1, horizon=1, forgets_done=self.program.first_step - 1)

    def first_step(self, state: StreamState) -> int:
        """Return the first step that is ground."""
        return self.program.first_step if state.past is None else state.past.first

    def check(self, update: Optional[StreamUpdate], horizon: int) -> None:
        """Raise SolverError where an update, or the ``horizon`` without one of a step, leads beyond the limit."""
        step = horizon if update is None or update.step is None else update.step
        limit = self.horizon_limit
        if limit is not None and step > limit:
            raise SolverError(f"step {step} is beyond the horizon limit {limit}; raise the limit or send a lower step")

    def steps_over(self, state: StreamState) -> int:
        """Return how many steps that are ground are over since it was tried last to retire some."""
        return state.keep_from - max(self.first_step(state), state.tried)

    def is_too_late(self, state: StreamState, atom: clingo.Symbol) -> bool:
        """Tell whether only steps that have been retired could have known of ``atom``, which nobody has told yet."""
        if state.past is None:
            return False
        program, last = self.program, state.past.first - 1
        if program.may_declare(atom, program.first_step, last):
            return not program.may_declare(atom, last + 1)
        known = program.is_open_signature(atom) and program.may_see([atom], program.first_step, last)
        return known and not program.may_mention(atom, last + 1)

    def read(self, update: StreamUpdate, state: StreamState) -> StreamUpdate:
        """Return the update as the program is to see it."""
        update = strings_apart(update) if self.oclingo_strings else update
        return _with_failures(update, state.permanent) if FAILED in self.program.open_signatures else update

    def open_heads(self, update: Optional[StreamUpdate]) -> List[clingo.Symbol]:
        """Return what the update defines of open signatures."""
        if update is None:
            return []
        heads = [one.head for _, one in self.read(update, self.fresh_state()).sections()]
        return [head for head in heads if head is not None and self.program.is_open_signature(head)]


def is_foreseen(update: StreamUpdate, before: Iterable[Statement]) -> bool:
    """Tell whether ``update`` holds nothing but commitments and the returns of what was done with success.

    ``before`` are the statements that hold for ever before it.
    """
    as_planned = _successes(update, before)
    plain = all(isinstance(item, (Statement, Cumulative, Closed, Over)) for item in update.items)
    statements = [one for _, one in update.sections()]
    return plain and all(one.head in as_planned or _demands_action(one) for one in statements)


def with_their_failures(facts: FrozenSet[clingo.Symbol]) -> FrozenSet[clingo.Symbol]:
    """Return ``facts`` and what was told of the returns among them."""
    return facts | {_failure_of(fact) for fact in facts if signature_of(fact) == RETURN}


def _with_failures(update: StreamUpdate, before: Iterable[Statement]) -> StreamUpdate:
    """Return ``update`` with each failure behind its return, given the statements that hold for ever ``before`` it."""
    told = {one.head for one in _lasting(update) if one.head is not None and signature_of(one.head) == RETURN}
    failed = told - _successes(update, before) if told else told
    if not failed:
        return update
    items: List[Item] = []
    for item in update.items:
        items.append(item)
        if isinstance(item, Statement) and item.head in failed and not item.body:
            items.append(Statement(_failure_of(item.head)))
    return replace(update, items=tuple(items))


def _failure_of(answer: clingo.Symbol) -> clingo.Symbol:
    """Return ``_failed(A,V,C)`` for ``_return(A,V,C)``."""
    return clingo.Function(FAILED.name, answer.arguments)


def _successes(update: StreamUpdate, before: Iterable[Statement]) -> Set[clingo.Symbol]:
    """Return the returns that tell of success: those of the actions that must be in every plan."""
    actions = (one.body[0].atom for one in (*before, *_lasting(update)) if _demands_action(one))
    return {clingo.Function(RETURN.name, action.arguments) for action in actions}


def _lasting(update: StreamUpdate) -> Iterator[Statement]:
    """Yield the facts and constraints of the update that hold for ever."""
    for section, statement in update.sections():
        if isinstance(section, Cumulative) and (statement.head is None or not statement.body):
            yield statement


def _demands_action(statement: Statement) -> bool:
    return statement.is_commitment and is_action(statement.body[0].atom)


def block_ends(state: StreamState, first: int, block: int, end: Optional[int] = None) -> Iterator[int]:
    """Yield the last steps of the blocks from ``first`` to ``end``, the horizon by default.

    One ends where steps may be retired.
    """
    end = state.horizon if end is None else min(end, state.horizon)
    while first <= end:
        last = min(first + block - 1, end)
        if first < state.keep_from <= last:
            last = state.keep_from - 1
        yield last
        first = last + 1
