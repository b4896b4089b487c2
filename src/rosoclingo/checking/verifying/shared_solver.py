"""Solvers over one grounding: to take an update, to go back, or to go another way costs a search only.

For who looks at many streams of one program. All facts that may come are assumable, and each question says which were
told and what was done.
"""

from dataclasses import replace
from typing import Any, Callable, Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple

import clingo

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import Statement, StreamUpdate
from rosoclingo.oclingo.solving.results import NOT_EXTERNAL, SolveOutcome, SolveResult
from rosoclingo.oclingo.solving.stream_state import TimedStatement
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import AcceptedUpdate, Plan
from rosoclingo.planning.planning_solver import PlanningSolver
from rosoclingo.planning.question import Question, Read, Reply, StoppedError
from rosoclingo.planning.snapshot import Snapshot

Readers = Callable[[Grounding, int], Sequence[Read]]
"""What to read of an answer's model, given its grounding and the step of the update."""

_FIRST, _GROWTH = 16, 2
"""Steps of the first grounding, and by how much each further one is longer."""

_BRIEFLY: Dict[str, Any] = {"believes": False, "blames": False, "brief": True, "conflicts": 20_000}
"""How questions are asked: with so many conflicts between two looks at the stop."""

_MOST = 16
"""Answers of one update whose present actions differ, at most."""


class SharedAnswer(NamedTuple):
    """An answer: the actions of the present step, what is shown, its horizon, and what was read of the model."""

    actions: FrozenSet[clingo.Symbol]
    shown: FrozenSet[clingo.Symbol]
    horizon: int
    read: Tuple[FrozenSet[clingo.Symbol], ...]


class Choices:
    """Which of several answers are taken, one after the other, and how many there were each time."""

    def __init__(self, script: Sequence[int] = ()) -> None:
        self._script, self.counts = script, []  # type: Sequence[int], List[int]

    def choose(self, found: Sequence[SharedAnswer]) -> SharedAnswer:
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
        readers: Readers = lambda grounding, step: (),
        halt: Callable[[], bool] = lambda: False,
        all_plans: bool = True,
    ) -> None:
        """Take facts that may come, of cycle 1 where they have one. ``halt`` ends any search, by StoppedError."""
        self.program = program
        self.choices, self.searches = Choices(), 0
        self._known: Set[clingo.Symbol] = {retimed(one, 1) for one in known}
        self._readers, self._halt = readers, halt
        self._most = _MOST if all_plans else 1
        self._groundings: List[Grounding] = []

    @property
    def known(self) -> FrozenSet[clingo.Symbol]:
        """The facts that may come, of cycle 1."""
        return frozenset(self._known)

    def actions(self) -> Set[Tuple[clingo.Symbol, clingo.Symbol]]:
        """Return what actions may be taken: names and parameters."""
        grounding = self._grounding(1)
        return {(one.arguments[0], one.arguments[1]) for one in grounding.actions(1, grounding.horizon)}

    def learn(self, facts: Iterable[clingo.Symbol]) -> None:
        """Know of further facts."""
        new = {retimed(one, 1) for one in facts} - self._known
        if new:
            self._known |= new
            self._groundings.clear()

    def least(self, snapshot: Snapshot, bound: int, hint: int) -> Optional[Tuple[Grounding, Question, int]]:
        """Return the least horizon, up to ``bound`` steps on, of an answer, with its grounding and question."""
        first, last, beyond = snapshot.step, snapshot.step + bound, snapshot.step
        told = frozenset(one.head for one in snapshot.statements if one.head is not None)
        while True:
            grounding = self._grounding(beyond, told)
            question = self._question(grounding, snapshot, told)
            end = min(grounding.horizon, last)
            found = None if question is None else self._descend(grounding, question, first, end, hint)
            if found is not None and question is not None:
                return grounding, question, found
            if end >= last:
                return None
            first, beyond = end + 1, end + 1

    @staticmethod
    def _question(grounding: Grounding, snapshot: Snapshot, told: FrozenSet[clingo.Symbol]) -> Optional[Question]:
        """Return the question for an answer after a snapshot; None if something demanded is not there."""
        demanded = [one.body[0].atom for one in snapshot.statements if one.is_commitment]
        if not all(map(grounding.definitions.knows, demanded)):
            return None
        done = (
            (atom, atom in executed)
            for cycle, executed in snapshot.closed.items()
            for atom in grounding.actions(cycle, cycle)
        )
        disabled = grounding.assumable - told
        return Question(0, 0, tuple(done), kept=demanded, disabled=disabled, **_BRIEFLY)

    def _descend(self, grounding: Grounding, question: Question, first: int, last: int, hint: int) -> Optional[int]:
        ends = [one for one in (max(hint, first), max(hint, first) + 3) if one < last]
        start, found = first, None
        for end in [*ends, last]:
            found = self._horizon(grounding, question, start, end)
            if found is not None:
                break
            start = end + 1
        while found is not None and found > start:
            lower = self._horizon(grounding, question, start, found - 1)
            if lower is None:
                break
            found = lower
        return found

    def _horizon(self, grounding: Grounding, question: Question, first: int, last: int) -> Optional[int]:
        reply = self._ask(grounding, question._replace(first=first, last=last, shows=False))
        return reply.horizon if reply.satisfiable else None

    def _ask(self, grounding: Grounding, question: Question) -> Reply:
        self.searches += 1
        while True:
            reply = grounding.ask(question, self._halt)
            if reply.satisfiable is not None:
                return reply
            if self._halt():
                raise StoppedError

    def answers(self, snapshot: Snapshot, bound: int, hint: int, several: bool) -> List[SharedAnswer]:
        """Return the answers of the least horizon whose present actions differ, or one of them."""
        least = self.least(snapshot, bound, hint)
        if least is None:
            return []
        grounding, question, horizon = least
        step = snapshot.step
        actions = frozenset(grounding.actions(step, step))
        reply = self._ask(
            grounding,
            question._replace(
                first=horizon,
                last=horizon,
                models=self._most if several else 1,
                differ=tuple(actions),
                reads=(lambda model: _true(model, actions), *self._readers(grounding, step)),
            ),
        )
        found = [SharedAnswer(read[0], shown, horizon, read[1:]) for shown, read in zip(reply.answers, reply.read)]
        return sorted(found, key=lambda one: sorted(one.actions))

    def _grounding(self, last: int, told: FrozenSet[clingo.Symbol] = frozenset()) -> Grounding:
        """Return a grounding of ``last`` steps at least that knows what was ``told``."""
        self.learn(told)
        fitting = [one for one in self._groundings if one.horizon >= last]
        if fitting:
            return fitting[0]
        end = max(_FIRST, self._groundings[-1].horizon * _GROWTH if self._groundings else 0)
        while end < last:
            end *= _GROWTH
        first = self.program.first_step
        facts = {retimed(one, cycle) for one in self._known for cycle in range(first, end + 2)}
        entries = tuple(TimedStatement(Statement(one), FOREVER, 1) for one in sorted(facts))
        snapshot = Snapshot(first, end, min_horizon=first, number=1, items=entries)
        self._groundings.append(Grounding(self.program, snapshot, end, frozenset(facts)))
        return self._groundings[-1]


def _true(model: clingo.Model, atoms: Iterable[clingo.Symbol]) -> FrozenSet[clingo.Symbol]:
    return frozenset(filter(model.contains, atoms))


def retimed(fact: clingo.Symbol, cycle: int) -> clingo.Symbol:
    """Return a fact, of ``cycle`` where it has one: where its last argument is a number."""
    if not fact.arguments or fact.arguments[-1].type is not clingo.SymbolType.Number:
        return fact
    return clingo.Function(fact.name, [*fact.arguments[:-1], clingo.Number(cycle)], fact.positive)


class SharedSolver(PlanningSolver):
    """A solver of shortest plans that asks the groundings of ``streams``.

    It takes facts, commitments and what updates say of the past; rules with a body it does not.

    Attributes:
        found: the last answer.

    """

    def __init__(self, streams: Streams) -> None:
        super().__init__()
        self._streams = streams
        self.found: Optional[SharedAnswer] = None

    @property
    def snapshot(self) -> Snapshot:
        """What is in force after the whole history."""
        return self.log.snapshot(self._streams.program)

    def _search(self, update: Optional[StreamUpdate], stopped: Callable[[], bool]) -> SolveResult:
        """Take ``update`` and return an answer of the least horizon; raises SolverError and StoppedError."""
        update = update or StreamUpdate()
        snapshot = self._after(update)
        bound = 0 if update.bound is None else update.bound
        plan, several = self.log.plan, not any(snapshot.lapsing)
        hint = snapshot.step if plan is None else plan.horizon
        found = self._streams.answers(snapshot, bound, hint, several)
        self.found = self._streams.choices.choose(found) if found else None
        horizon = snapshot.step + bound if self.found is None else self.found.horizon
        outcome = SolveOutcome.UNSATISFIABLE if self.found is None else SolveOutcome.SATISFIABLE
        answers = () if self.found is None else (self.found.shown,)
        warnings = self._ignored(update)
        spent = {"solve": 0.0, "ground": 0.0, "needed": 0.0}
        result = SolveResult(outcome, answers, horizon, snapshot.step, warnings, statistics=spent, shortest=True)
        self.log = self.log.with_entries(AcceptedUpdate(update, horizon)).adopt(Plan.from_result(result))
        return result

    def _after(self, update: StreamUpdate) -> Snapshot:
        """Return the snapshot with an update; raises SolverError for rules."""
        snapshot = self.snapshot.with_update(update, self._streams.program)
        strange = next((one for one in snapshot.statements if one.body and not one.is_commitment), None)
        if strange is not None:
            raise SolverError(f"only facts and executed actions can be fed here, not {strange}")
        return snapshot

    def _ignored(self, update: StreamUpdate) -> Tuple[str, ...]:
        """Return warnings, in the solver's words, of facts that the program declares no external for."""
        heads = [one.head for _, one in update.sections() if one.head is not None]
        strange = [one for one in heads if signature_of(one) not in self._streams.program.external_signatures]
        return tuple(NOT_EXTERNAL.format(one) for one in strange)

    @staticmethod
    def improve(stopped: Optional[Callable[[], bool]] = None) -> Optional[SolveResult]:
        """Return None, as plans are shortest."""
        return None

    @staticmethod
    def compact(stopped: Optional[Callable[[], bool]] = None) -> None:
        """Leave the history as it is, as long as it may be."""

    def inquire(
        self,
        update: StreamUpdate,
        assumable: FrozenSet[clingo.Symbol],
        disabled: FrozenSet[clingo.Symbol],
        stopped: Optional[Callable[[], bool]] = None,
    ) -> Reply:
        """Tell whether there would be an answer after ``update``, had the facts ``disabled`` not been told."""
        snapshot = self._after(replace(update, bound=None)).without_facts(disabled)
        bound = 0 if update.bound is None else update.bound
        found = self._streams.least(snapshot, bound, self.log.horizon)
        return Reply(found is not None, core=frozenset() if found is not None else assumable)
