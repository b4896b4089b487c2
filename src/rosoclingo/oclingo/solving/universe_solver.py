"""Reactive solvers over one universe of facts: to take an update, to go back, or to go another way costs a search only.

For who looks at many streams of one program: all solvers share the groundings of a :class:`Streams`.
"""

from dataclasses import replace
from typing import Callable, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple

import clingo

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.action_rules import is_action_of
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import Anew, Closed, Cumulative, StreamUpdate
from rosoclingo.oclingo.solving.inquiry import Verdict
from rosoclingo.oclingo.solving.solver import SolveOutcome, SolveResult
from rosoclingo.oclingo.solving.stream_log import Close, Entry, LoggedSolver, StreamLog, Taken, Withdrawal
from rosoclingo.oclingo.solving.stream_state import UPDATE, Lapsing, Setting, StreamState
from rosoclingo.oclingo.solving.universe import Found, Read, StoppedError, Universe

__all__ = ["Choices", "Found", "StoppedError", "Streams", "UniverseSolver", "retimed"]

Readers = Callable[[Universe, int], Sequence[Read]]
"""What to read of an answer's model, given its grounding and the step of the update."""

_FIRST, _GROWTH = 16, 2
"""Steps of the first grounding, and by how much each further one is longer."""

_MOST = 16
"""Answers of one update whose present actions differ, at most."""


class Choices:
    """Which of several answers are taken, one after the other, and how many there were each time."""

    def __init__(self, script: Sequence[int] = ()) -> None:
        self._script, self.counts = script, []  # type: Sequence[int], List[int]

    def choose(self, found: Sequence[Found]) -> Found:
        """Return the answer that it is the turn of."""
        if len(found) == 1:
            return found[0]
        place = len(self.counts)
        self.counts.append(len(found))
        return found[self._script[place] if place < len(self._script) else 0]

    def following(self) -> Optional["Choices"]:
        """Return the next choices that differ, None where there are no more."""
        script = [self._script[n] if n < len(self._script) else 0 for n in range(len(self.counts))]
        while script and script[-1] + 1 >= self.counts[len(script) - 1]:
            script.pop()
        if not script:
            return None
        script[-1] += 1
        return Choices(script)


class Query(NamedTuple):
    """What an answer depends on."""

    step: int
    told: FrozenSet[clingo.Symbol]
    closed: Tuple[Tuple[int, FrozenSet[clingo.Symbol]], ...]
    demanded: FrozenSet[clingo.Symbol]


class Streams:
    """All streams over facts like those that are known, of which those of any cycle are taken.

    Attributes:
        choices: which of several answers solvers take.
        searches: how many searches there were.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        known: Iterable[clingo.Symbol],
        readers: Readers = lambda universe, step: (),
        halt: Callable[[], bool] = lambda: False,
        all_plans: bool = True,
    ) -> None:
        """Take facts that may come, of cycle 1 where they have one. ``halt`` ends any search, by StoppedError."""
        self.program = program
        self.setting = Setting(program, shortest=True)
        self.choices, self.searches = Choices(), 0
        self._known: Set[clingo.Symbol] = {retimed(one, 1) for one in known}
        self._readers, self._halt = readers, halt
        self._most = _MOST if all_plans else 1
        self._universes: List[Universe] = []

    @property
    def known(self) -> FrozenSet[clingo.Symbol]:
        """The facts that may come, of cycle 1."""
        return frozenset(self._known)

    def actions(self) -> Set[Tuple[clingo.Symbol, clingo.Symbol]]:
        """Return what actions may be taken: names and parameters."""
        universe = self._universe(1)
        return {(one.arguments[0], one.arguments[1]) for one in universe.actions(1, universe.horizon)}

    def learn(self, facts: Iterable[clingo.Symbol]) -> None:
        """Know of further facts."""
        new = {retimed(one, 1) for one in facts} - self._known
        if new:
            self._known |= new
            self._universes.clear()

    def least(self, query: Query, bound: int, hint: int) -> Optional[Tuple[Universe, List[int], int]]:
        """Return the least horizon, up to ``bound`` steps on, of an answer, with the grounding and what is assumed."""
        first, last, beyond = query.step, query.step + bound, query.step
        while True:
            universe = self._universe(beyond, query.told)
            assumed = universe.assumed(query.told, dict(query.closed), query.demanded)
            end = min(universe.horizon, last)
            found = self._descend(universe, assumed, first, end, hint)
            if found is not None:
                return universe, assumed, found
            if end >= last:
                return None
            first, beyond = end + 1, end + 1

    def _descend(self, universe: Universe, assumed: List[int], first: int, last: int, hint: int) -> Optional[int]:
        ends = [one for one in (max(hint, first), max(hint, first) + 3) if one < last]
        start, found = first, None
        for end in [*ends, last]:
            found = self._horizon(universe, assumed, start, end)
            if found is not None:
                break
            start = end + 1
        while found is not None and found > start:
            lower = self._horizon(universe, assumed, start, found - 1)
            if lower is None:
                break
            found = lower
        return found

    def _horizon(self, universe: Universe, assumed: List[int], first: int, last: int) -> Optional[int]:
        self.searches += 1
        return universe.horizon_in(assumed, first, last, self._halt)

    def answers(self, query: Query, bound: int, hint: int, several: bool) -> List[Found]:
        """Return the answers of the least horizon whose present actions differ, or one of them."""
        least = self.least(query, bound, hint)
        if least is None:
            return []
        universe, assumed, horizon = least
        self.searches += 1
        most, reads = (self._most if several else 1), self._readers(universe, query.step)
        return universe.answers(assumed, horizon, query.step, most, reads, self._halt)

    def _universe(self, last: int, told: FrozenSet[clingo.Symbol] = frozenset()) -> Universe:
        """Return a grounding of ``last`` steps at least that knows what was ``told``."""
        self.learn(told)
        fitting = [one for one in self._universes if one.horizon >= last]
        if fitting:
            return fitting[0]
        end = max(_FIRST, self._universes[-1].horizon * _GROWTH if self._universes else 0)
        while end < last:
            end *= _GROWTH
        facts = {retimed(one, cycle) for one in self._known for cycle in range(self.program.first_step, end + 2)}
        self._universes.append(Universe(self.program, sorted(facts), end))
        return self._universes[-1]


def retimed(fact: clingo.Symbol, cycle: int) -> clingo.Symbol:
    """Return a fact, of ``cycle`` where it has one: where its last argument is a number."""
    if not fact.arguments or fact.arguments[-1].type is not clingo.SymbolType.Number:
        return fact
    return clingo.Function(fact.name, [*fact.arguments[:-1], clingo.Number(cycle)], fact.positive)


class UniverseSolver(LoggedSolver):
    """A reactive solver of shortest plans that asks the groundings of ``streams``.

    It takes facts, commitments and what updates say of the past; rules with a body it does not.

    Attributes:
        found: the last answer.

    """

    def __init__(self, streams: Streams) -> None:
        super().__init__()
        self._streams = streams
        self.found: Optional[Found] = None

    def update(self, update: StreamUpdate, stopped: Optional[Callable[[], bool]] = None) -> SolveResult:
        """Take ``update`` and return an answer of the least horizon; raises SolverError and StoppedError."""
        state = self._after(self._state_after(self._log), Taken(update, 0))
        bound = 0 if update.bound is None else update.bound
        plan, several = self._log.plan, not state.lapsing
        hint = state.step if plan is None else plan.horizon
        found = self._streams.answers(_query(state), bound, hint, several)
        self.found = self._streams.choices.choose(found) if found else None
        horizon = state.step + bound if self.found is None else self.found.horizon
        log = self._log.then(Taken(update, horizon))
        log.state = replace(state, horizon=horizon)
        outcome = SolveOutcome.UNSATISFIABLE if self.found is None else SolveOutcome.SATISFIABLE
        answers = () if self.found is None else (self.found.shown,)
        warnings = self._ignored(update)
        spent = {"solve": 0.0, "ground": 0.0, "needed": 0.0}
        result = SolveResult(outcome, answers, horizon, state.step, warnings, statistics=spent, shortest=True)
        log.plan = result.plan or log.plan
        self._log = log
        return result

    @property
    def state(self) -> StreamState:
        """The state after the whole log, not to be changed."""
        return self._state_after(self._log)

    def _ignored(self, update: StreamUpdate) -> Tuple[str, ...]:
        """Return warnings, in the solver's words, of facts that the program declares no external for."""
        heads = [one.head for _, one in update.sections() if one.head is not None]
        strange = [one for one in heads if signature_of(one) not in self._streams.program.external_signatures]
        return tuple(f"Head {one} has not been declared external. The entire rule will be ignored." for one in strange)

    @staticmethod
    def improve(stopped: Optional[Callable[[], bool]] = None) -> Optional[SolveResult]:
        """Return None, as plans are shortest."""
        return None

    def inquire(
        self,
        update: StreamUpdate,
        doubted: FrozenSet[clingo.Symbol],
        untold: FrozenSet[clingo.Symbol],
        stopped: Optional[Callable[[], bool]] = None,
    ) -> Verdict:
        """Tell whether there would be an answer after ``update``, had the facts ``untold`` not been told."""
        state = self._after(self._state_after(self._log), Taken(update, 0)).less(untold)
        bound = 0 if update.bound is None else update.bound
        found = self._streams.least(_query(state), bound, self._log.horizon)
        return Verdict(found is not None, frozenset() if found is not None else doubted)

    def _state_after(self, log: StreamLog) -> StreamState:
        """Return the state after a log."""
        unread: List[StreamLog] = []
        one = log
        while one.state is None and one.before is not None:
            unread.append(one)
            one = one.before
        state = one.state or self._streams.setting.fresh_state()
        for one in reversed(unread):
            state = one.state = self._after(state, one.entry)
        return state

    def _after(self, before: StreamState, entry: Optional[Entry]) -> StreamState:
        """Return the state after one more entry of the log."""
        state = before.copy()
        if isinstance(entry, Withdrawal):
            return state.less(entry.facts)
        if isinstance(entry, Close):
            state.closed_cycles[entry.cycle] = entry.executed
        if not isinstance(entry, Taken) or entry.update is None:
            return state
        update = self._streams.setting.read(entry.update, state)
        if Anew() in update.items:
            state = self._streams.setting.fresh_state()
        state = state.less(update.withdrawn) if update.withdrawn else state
        for item in update.items:
            for cycle in range(item.first, item.last + 1) if isinstance(item, Closed) else ():
                state.closed_cycles[cycle] = frozenset(filter(is_action_of(cycle), update.committed))
        state.step = state.step if update.step is None else update.step
        state.lapsing = []
        for section, statement in update.sections():
            if isinstance(section, Cumulative):
                state.permanent.append(statement)
            else:
                state.lapsing.append(Lapsing(statement, UPDATE))
        return state


def _query(state: StreamState) -> Query:
    statements = [*state.permanent, *(one.statement for one in state.lapsing)]
    strange = [one for one in statements if one.body and not one.is_commitment]
    if strange:
        raise SolverError(f"only facts and executed actions can be fed here, not {strange[0]}")
    told = frozenset(one.head for one in statements if one.head is not None)
    closed = tuple(sorted((cycle, done) for cycle, done in state.closed_cycles.items()))
    return Query(state.step, told, closed, frozenset(one.body[0].atom for one in statements if one.body))
