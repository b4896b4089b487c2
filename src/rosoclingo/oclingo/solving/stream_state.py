"""The state of a stream between two updates: a fold of the updates, without clingo.

The incremental solver uses it directly. The planner extends it by the past of a robot
(:class:`~rosoclingo.planning.snapshot.Snapshot`).
"""

from dataclasses import dataclass, field, replace
from typing import (
    Callable,
    Dict,
    FrozenSet,
    Iterable,
    Iterator,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Set,
    Tuple,
    Type,
    TypeVar,
    Union,
)

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.update_reader import closed_cycles, with_failures, with_their_failures
from rosoclingo.oclingo.progression.lifetimes import FOREVER, UPDATE, Lifetime, lifetime_of
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.oclingo.progression.updates import (
    Assert,
    Cumulative,
    Expire,
    Forget,
    Reset,
    Retract,
    Section,
    Statement,
    StreamUpdate,
    Volatile,
)
from rosoclingo.oclingo.reachable import reachable

State = TypeVar("State", bound="StreamState")


class TimedStatement(NamedTuple):
    """A statement with its lifetime and the number of its update.

    The number is 0 for statements asserted before the step that declares their head: all of these define the head.
    """

    statement: Statement
    lifetime: Lifetime
    update: int


class ForgottenSteps(NamedTuple):
    """The steps ``first`` to ``last``, whose undefined externals are permanently false.

    An external is undefined if no earlier statement defines it. ``spared`` heads, which lapsing statements define, stay
    open.
    """

    first: int
    last: int
    spared: FrozenSet[clingo.Symbol] = frozenset()


class ClosedHeads(NamedTuple):
    """Atoms of compacted steps that no later statement can define."""

    atoms: FrozenSet[clingo.Symbol]


StateItem = Union[TimedStatement, ForgottenSteps, ClosedHeads]


@dataclass(frozen=True)
class StreamState:
    """The state of a stream between two updates.

    It keeps every statement of an update, as only a grounding knows which heads are declared external. The grounding
    ignores the other statements.

    Attributes:
        step: k, the step of the last update.
        horizon: N, the horizon at which the next search begins.
        bound: B, the greatest horizon to search, None for no bound.
        min_horizon: the lowest horizon of the next search: the greatest step of all updates; N in the incremental
            solver.
        number: the number of updates so far.
        items: statements, forgotten steps and closed heads, in order; also statements whose head is not declared
            external.
        closed: the actions that were executed in each closed cycle.
        keep_from: all steps before it are over.
        warnings: warnings about ignored items of the last update; not compared.

    """

    step: int = 1
    horizon: int = 1
    bound: Optional[int] = None
    min_horizon: int = 1
    number: int = 0
    items: Tuple[StateItem, ...] = ()
    closed: Mapping[int, FrozenSet[clingo.Symbol]] = field(default_factory=dict)
    keep_from: int = 0
    warnings: Tuple[str, ...] = field(default=(), compare=False)

    @classmethod
    def initial(cls: Type[State], program: ReactiveProgram) -> State:
        """Return the state before the first update."""
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
    def heads(self) -> Dict[clingo.Symbol, None]:
        """The heads of the statements, in order."""
        return dict.fromkeys(one.head for one in self.statements if one.head is not None)

    def permanent_facts(self, assumable: FrozenSet[clingo.Symbol] = frozenset()) -> Dict[clingo.Symbol, int]:
        """Return the facts that never lapse, except ``assumable`` ones, with the numbers of their updates.

        The first update that permanently defines a head closes it: later statements are ignored.
        """
        closing: Dict[clingo.Symbol, int] = {}
        facts: Dict[clingo.Symbol, int] = {}
        omitted = with_their_failures(assumable)
        for statement, lifetime, number in self.timed_statements:
            head = statement.head
            if head is None or lifetime != FOREVER or head in omitted:
                continue
            if closing.setdefault(head, number) == number and not statement.body:
                facts[head] = number
        return facts

    def closes_loops(self, program: ReactiveProgram) -> bool:
        """Return whether a statement closes a positive loop through the program."""
        dependents: Dict[Signature, Set[Signature]] = {}

        def successors(signature: Signature) -> Set[Signature]:
            """Return the predicates that depend on another one by a rule of the program or of the stream."""
            return program.dependents.get(signature, set()) | dependents.get(signature, set())

        for one in self.statements:
            bodies = {signature_of(literal.atom) for literal in one.body if literal.positive}
            if one.head is not None and bodies:
                head = signature_of(one.head)
                users = reachable([head], successors)
                if users & bodies:
                    return True
                for body in bodies:
                    dependents.setdefault(body, set()).add(head)
        return False

    # ---- Changes -----------------------------------------------------------------------------------------------------

    def with_update(self: State, update: Optional[StreamUpdate], program: ReactiveProgram) -> State:
        """Return the state after ``update``, with a horizon of at least its step."""
        if update is None:
            return replace(self, number=self.number + 1, warnings=())  # each warning is reported once
        number = self.number + 1
        update = with_failures(program, update, self.permanent)
        start = self.initial(program) if Reset() in update.items else self
        over = (item.step for item in update.items if isinstance(item, Expire))
        closed = {**start.closed, **closed_cycles(update, program.first_step, start.step)}
        start = replace(start, closed=closed, keep_from=max([start.keep_from, *over])).without_facts(update.withdrawn)
        step, bound = start.step, start.bound
        if update.step is not None:
            step, bound = update.step, None if update.bound is None else update.step + update.bound
        min_horizon, horizon = max(start.min_horizon, step), max(start.horizon, step)
        kept = [one for one in start.items if not _has_passed(one, min_horizon, with_update=True)]
        timely, late_warnings = start._without_late(update)

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

    def with_horizon(self: State, horizon: int, program: ReactiveProgram) -> State:
        """Return the state in which the next search begins at ``horizon``; steps are forgotten only once."""
        horizon = max(horizon, self.horizon) if program.forgets else horizon
        forgotten = _forgotten(program, self.horizon + 1, horizon, self.items)
        return replace(self, horizon=horizon, items=(*self.items, *forgotten))

    def with_growth(self: State, horizon: int, program: ReactiveProgram) -> State:
        """Return the state after a step-by-step search up to ``horizon``, the lowest horizon of later searches."""
        state = replace(self, horizon=min(self.horizon, horizon), min_horizon=horizon)
        for step in range(state.horizon + 1, horizon + 1):
            items = (one for one in state.items if not _has_passed(one, step))
            state = replace(state, items=tuple(items)).with_horizon(step, program)
        return state

    def without_facts(self: State, facts: FrozenSet[clingo.Symbol]) -> State:
        """Return the state as if ``facts`` had not been asserted, and actions among them not executed."""
        if not facts:
            return self
        facts = with_their_failures(facts)
        items = tuple(
            one for one in self.items if not (isinstance(one, TimedStatement) and one.statement.subject in facts)
        )
        return replace(self, items=items, closed={cycle: executed - facts for cycle, executed in self.closed.items()})

    def _without_late(self, update: StreamUpdate) -> Tuple[StreamUpdate, Tuple[str, ...]]:
        """Return ``update`` without facts that come too late for the state, and warnings about them."""
        return update, ()


def _has_passed(item: StateItem, min_horizon: int, with_update: bool = False) -> bool:
    """Return whether the window of a statement ends before ``min_horizon``, or it ends with the next update."""
    if not isinstance(item, TimedStatement):
        return False
    ends = isinstance(item.lifetime, int) and item.lifetime < min_horizon
    return ends or (with_update and item.lifetime == UPDATE)


def _with_statements(
    kept: List[StateItem],
    update: StreamUpdate,
    step: int,
    min_horizon: int,
    number_of: Callable[[Statement], int],
) -> Tuple[List[StateItem], Tuple[str, ...]]:
    """Apply the assertions and retractions of ``update`` to ``kept``; return the items and the warnings."""
    items, warnings = list(kept), []
    section: Section = Cumulative()
    for item in update.items:
        if isinstance(item, Statement):
            timed = TimedStatement(item, lifetime_of(section, step), number_of(item))
            if not (_has_passed(timed, min_horizon) or item.is_tautology):
                items.append(timed)
        elif isinstance(item, Retract):
            rest = [one for one in items if not (isinstance(one, TimedStatement) and one.lifetime == Assert(item.term))]
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
    items: Iterable[StateItem] = (),
    requested: Iterable[ForgottenSteps] = (),
) -> List[ForgottenSteps]:
    """Return the steps that are forgotten when ``first`` to ``last`` are grounded, after the ``requested`` ones.

    Heads defined by lapsing statements of ``items`` are spared.
    """
    forgotten = list(requested)
    for at in range(first, last + 1) if program.forgets else ():
        steps = [one.number(program.values, [], at) for one in program.forgets]
        forgotten += [ForgottenSteps(step, step) for step in steps if step < at]
    if not forgotten:
        return []
    lapsing = (one.statement.head for one in items if isinstance(one, TimedStatement) and one.lifetime != FOREVER)
    spared = frozenset(head for head in lapsing if head is not None)
    return [one._replace(spared=spared) for one in forgotten]
