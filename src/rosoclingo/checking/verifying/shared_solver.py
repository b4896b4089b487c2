"""Solvers that share one grounding, so that an update, backtracking or another branch costs only a search.

All facts that can occur are assumable; each question assumes the reported facts and the executed actions. The
verification uses this to explore many streams of one program.
"""

from dataclasses import replace
from typing import Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple

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
from rosoclingo.planning.question import Question, Reply, Stop
from rosoclingo.planning.snapshot import Snapshot

_FIRST, _GROWTH = 16, 2
"""Steps of the first grounding, and the factor by which further ones are longer."""

_MOST = 16
"""Greatest number of answers of one update with different present actions."""


class HaltedError(Exception):
    """The verification was stopped; the core under test must not handle this."""


class SharedAnswer(NamedTuple):
    """An answer: the actions of the present step, the shown atoms, the horizon, and all true atoms."""

    actions: FrozenSet[clingo.Symbol]
    shown: FrozenSet[clingo.Symbol]
    horizon: int
    atoms: FrozenSet[clingo.Symbol]


class Choices:
    """A branch of the search: the index of the answer to choose each time; 0 after the end of the ``script``."""

    def __init__(self, script: Sequence[int] = ()) -> None:
        self._script, self._counts = script, []  # type: Sequence[int], List[int]

    def choose(self, found: Sequence[SharedAnswer]) -> SharedAnswer:
        """Return the answer of this branch."""
        place = len(self._counts)
        self._counts.append(len(found))
        return found[self._script[place] if place < len(self._script) else 0]

    def following(self) -> Optional["Choices"]:
        """Return the next branch, None after the last one."""
        script = [*self._script, *[0] * len(self._counts)][: len(self._counts)]
        while script and script[-1] + 1 >= self._counts[len(script) - 1]:
            script.pop()
        return Choices([*script[:-1], script[-1] + 1]) if script else None


class Streams:
    """The groundings for all streams of a program over some facts; its solvers follow ``choices``."""

    def __init__(
        self,
        program: ReactiveProgram,
        known: Iterable[clingo.Symbol],
        halt: Stop = lambda: False,
        all_plans: bool = True,
    ) -> None:
        """Start with the ``known`` facts, of any cycle if they have one.

        A search that ``halt`` ends raises HaltedError.
        """
        self.program, self.choices = program, Choices()
        self._known: Set[clingo.Symbol] = set()
        self._halt, self._all_plans = halt, all_plans
        self._groundings: Dict[int, Grounding] = {}  # by the last step
        self.learn(known)

    def actions(self) -> Set[Tuple[clingo.Symbol, clingo.Symbol]]:
        """Return the possible actions as names and parameters."""
        grounding = self._grounding(1)
        return {(one.arguments[0], one.arguments[1]) for one in grounding.actions(1, grounding.horizon)}

    def learn(self, facts: Iterable[clingo.Symbol]) -> bool:
        """Add facts; return whether any of them is new, so that the program has to be regrounded."""
        before = len(self._known)
        self._known.update(redate(one, 1) for one in facts)
        if len(self._known) > before:
            self._groundings.clear()
        return len(self._known) > before

    def least(self, snapshot: Snapshot, bound: int, hint: int) -> Optional[Tuple[Grounding, Question]]:
        """Return the question for the least horizon with an answer, at most ``bound`` steps on, and its grounding."""
        first, last = snapshot.step, snapshot.step + bound
        facts = frozenset(one.head for one in snapshot.statements if one.head is not None)
        while True:
            self.learn(facts)
            grounding = self._grounding(first)
            question = _question(grounding, snapshot, facts)
            end = min(grounding.horizon, last)
            found = None if question is None else self._descend(grounding, question, first, end, max(hint, first))
            if found is not None or end >= last:
                return None if found is None else (grounding, found)
            first = end + 1

    def answers(self, snapshot: Snapshot, bound: int, hint: int) -> List[SharedAnswer]:
        """Return answers of the least horizon with different present actions; only one if a statement can lapse."""
        least = self.least(snapshot, bound, hint)
        if least is None:
            return []
        grounding, question = least
        actions = frozenset(grounding.actions(snapshot.step, snapshot.step))
        several = self._all_plans and not any(snapshot.lapsing)
        models = _MOST if several else 1
        reply = self._ask(grounding, question._replace(models=models, differ=tuple(actions), shows=True, whole=True))
        pairs = zip(reply.answers, reply.atoms)
        found = [SharedAnswer(atoms & actions, shown, reply.horizon, atoms) for shown, atoms in pairs]
        return sorted(found, key=lambda one: sorted(one.actions))

    def _descend(
        self, grounding: Grounding, question: Question, first: int, last: int, hint: int
    ) -> Optional[Question]:
        """Return the question for the least horizon in first..last with an answer; None if there is none."""
        reply = Reply(None)
        for end in sorted({min(hint, last), min(hint + 3, last), last}):
            reply = self._ask(grounding, question._replace(first=first, last=end))
            if reply.satisfiable:
                break
            first = end + 1
        while reply.satisfiable and reply.horizon > first:
            shorter = self._ask(grounding, question._replace(first=first, last=reply.horizon - 1))
            if not shorter.satisfiable:
                break
            reply = shorter
        return question._replace(first=reply.horizon, last=reply.horizon) if reply.satisfiable else None

    def _ask(self, grounding: Grounding, question: Question) -> Reply:
        reply = grounding.ask(question, self._halt)
        if reply.satisfiable is None:
            raise HaltedError
        return reply

    def _grounding(self, last: int) -> Grounding:
        """Return a grounding of at least ``last`` steps."""
        end = _FIRST
        while end < last:
            end *= _GROWTH
        if end not in self._groundings:
            first = self.program.first_step
            facts = frozenset(redate(one, cycle) for one in self._known for cycle in range(first, end + 2))
            items = tuple(TimedStatement(Statement(one), FOREVER, 1) for one in sorted(facts))
            snapshot = Snapshot(first, end, min_horizon=first, number=1, items=items)
            self._groundings[end] = Grounding(self.program, snapshot, end, facts)
        return self._groundings[end]


def _question(grounding: Grounding, snapshot: Snapshot, facts: FrozenSet[clingo.Symbol]) -> Optional[Question]:
    """Return the question for an answer to a snapshot with these ``facts``; None if a committed action is unknown."""
    committed = [one.body[0].atom for one in snapshot.statements if one.is_commitment]
    if not all(map(grounding.definitions.knows, committed)):
        return None
    given = (
        (atom, atom in executed)
        for cycle, executed in snapshot.closed.items()
        for atom in grounding.actions(cycle, cycle)
    )
    disabled = grounding.assumable - facts
    return Question(0, 0, tuple(given), kept=committed, disabled=disabled, believes=False, shows=False)


def redate(fact: clingo.Symbol, cycle: int) -> clingo.Symbol:
    """Return a fact with another ``cycle``, which is its last argument if that is a number."""
    if not fact.arguments or fact.arguments[-1].type is not clingo.SymbolType.Number:
        return fact
    return clingo.Function(fact.name, [*fact.arguments[:-1], clingo.Number(cycle)], fact.positive)


class SharedSolver(PlanningSolver):
    """A solver of shortest plans that asks the groundings of ``streams``; ``found`` is its last answer.

    It accepts facts, commitments and closed cycles. It rejects rules.
    """

    def __init__(self, streams: Streams) -> None:
        super().__init__()
        self._streams = streams
        self.found: Optional[SharedAnswer] = None

    @property
    def snapshot(self) -> Snapshot:
        """The snapshot of the history."""
        return self.log.snapshot(self._streams.program)

    def search(self, update: Optional[StreamUpdate], stopped: Stop) -> SolveResult:
        """Accept ``update`` and return an answer of the least horizon; raises SolverError and HaltedError."""
        update = update or StreamUpdate()
        snapshot, bound, plan = self._after(update), update.bound or 0, self.log.plan
        found = self._streams.answers(snapshot, bound, snapshot.step if plan is None else plan.horizon)
        self.found = self._streams.choices.choose(found) if found else None
        horizon = snapshot.step + bound if self.found is None else self.found.horizon
        outcome = SolveOutcome.UNSATISFIABLE if self.found is None else SolveOutcome.SATISFIABLE
        answers = () if self.found is None else (self.found.shown,)
        externals = self._streams.program.external_signatures
        heads = (one.head for _, one in update.sections() if one.head is not None)
        warnings = tuple(NOT_EXTERNAL.format(one) for one in heads if signature_of(one) not in externals)
        spent = {"solve": 0.0, "ground": 0.0, "needed": 0.0}
        result = SolveResult(outcome, answers, horizon, snapshot.step, warnings, statistics=spent, shortest=True)
        self.log = self.log.with_entries(AcceptedUpdate(update, horizon)).adopt(Plan.from_result(result))
        return result

    def _after(self, update: StreamUpdate) -> Snapshot:
        """Return the snapshot with an update; raises SolverError for rules."""
        snapshot = self.snapshot.with_update(update, self._streams.program)
        rule = next((one for one in snapshot.statements if one.body and not one.is_commitment), None)
        if rule is not None:
            raise SolverError(f"only facts and executed actions are supported, not {rule}")
        return snapshot

    def inquire(
        self,
        update: StreamUpdate,
        assumable: FrozenSet[clingo.Symbol],
        disabled: FrozenSet[clingo.Symbol],
        stopped: Optional[Stop] = None,
    ) -> Reply:
        """Return whether ``update`` would have an answer without the ``disabled`` facts."""
        snapshot = self._after(replace(update, bound=None)).without_facts(disabled)
        found = self._streams.least(snapshot, update.bound or 0, self.log.horizon)
        return Reply(found is not None, core=frozenset() if found is not None else assumable)
