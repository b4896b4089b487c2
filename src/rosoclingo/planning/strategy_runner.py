"""Runs strategies: sends their questions to a grounding, and polls for a stop."""

import time
from copy import copy
from typing import Callable, FrozenSet, List, Optional, TypeVar

import clingo

from rosoclingo.oclingo.errors import StoppedError
from rosoclingo.oclingo.program.action_rules import TAKES
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.solving.stream_state import TimedStatement
from rosoclingo.planning.grounding import Grounding, pieces
from rosoclingo.planning.question import Assumptions, Question, Reply, Stop, Strategy, never
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.strategies.tour_actions import Durations, durations_of

T = TypeVar("T")

Build = Callable[[Snapshot, int, Stop], Grounding]
"""Grounds the program with a snapshot up to a horizon; raises StoppedError."""


class StrategyRunner:
    """Runs strategies on a snapshot, and extends its grounding as their questions require.

    Attributes:
        program: the reactive logic program.
        snapshot: the snapshot of the history.
        block: the number of steps to ground at once; 1 if further steps can invalidate an answer.
        grounding: the grounding.
        seconds: wall time spent in clingo's search so far.
        is_stopped: the stop function of the running strategy.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        snapshot: Snapshot,
        build: Build,
        block: int,
        limit: Optional[int] = None,
        stopped: Stop = never,
    ) -> None:
        """Ground the program up to the horizon of ``snapshot``; raises StoppedError if ``stopped`` returns true.

        Steps after ``limit`` are never grounded.
        """
        self.program, self.snapshot, self.block = program, snapshot, block
        self._build, self._limit = build, limit
        self.grounding = build(snapshot, snapshot.horizon, stopped)
        self.seconds = 0.0
        self.is_stopped: Stop = stopped
        self._asserted: FrozenSet[clingo.Symbol] = frozenset()
        self._executed: Assumptions = ()

    def run(self, strategy: Strategy[T], stopped: Stop) -> T:
        """Return the result of ``strategy``; raises :class:`StoppedError` if a stop ends it without a result."""
        self.is_stopped = stopped
        try:
            question = next(strategy)
            while True:
                try:
                    reply = self._ask(question)
                except StoppedError as stop:
                    question = strategy.throw(stop)
                else:
                    question = strategy.send(reply)
        except StopIteration as end:
            result: T = end.value
            return result

    def following(self, snapshot: Snapshot) -> "Optional[StrategyRunner]":
        """Return a runner for a later ``snapshot`` with the same grounding; None if it has to be regrounded.

        The later updates can close cycles, commit to actions, and assert facts for which the grounding has externals.
        All questions assume these.
        """
        if snapshot is self.snapshot:
            return self
        base, grounding = self.grounding.snapshot, self.grounding
        new = snapshot.items[len(base.items) :]
        statements = [one.statement for one in new if isinstance(one, TimedStatement) and one.lifetime == FOREVER]
        heads = frozenset(one.head for one in statements if one.head is not None and not one.body)
        facts = frozenset(one for one in heads if self.program.can_mention(one, self.program.first_step))
        cycles = snapshot.closed.keys() - base.closed.keys()
        executed = frozenset(one for cycle in cycles for one in snapshot.closed[cycle])
        actions = [one for cycle in sorted(cycles) for one in grounding.actions(cycle, cycle)]
        if (
            not grounding.grows
            or self.program.forgets
            or snapshot.warnings
            or (snapshot.past, snapshot.items[: len(base.items)]) != (base.past, base.items)
            or len(statements) < len(new)
            or not all(one.body[0].atom in executed if one.is_commitment else one.head in heads for one in statements)
            or not executed.issubset(actions)
            or not all(map(grounding.definitions.is_undefined, facts))
        ):
            return None
        runner = copy(self)
        runner.snapshot, runner.seconds, runner.is_stopped = snapshot, 0.0, never
        runner._asserted, runner._executed = facts, [(action, action in executed) for action in actions]
        runner.ground(snapshot.horizon)
        return runner

    @property
    def follows(self) -> bool:
        """Whether the grounding was built from an earlier snapshot."""
        return self.snapshot.number != self.grounding.snapshot.number

    # ---- For strategies ----------------------------------------------------------------------------------------------

    @property
    def step(self) -> int:
        """The step of the last update."""
        return self.snapshot.step

    @property
    def min_horizon(self) -> int:
        """The least possible horizon of an answer."""
        return self.snapshot.min_horizon

    @property
    def horizon(self) -> int:
        """The last grounded step."""
        return self.grounding.horizon

    @property
    def durations(self) -> Durations:
        """The durations of actions that the stream states; none if rules of the program use them."""
        heads = (one.head for one in self.snapshot.statements if one.head is not None)
        stated = (one for one in heads if signature_of(one) == TAKES)
        return durations_of(one for one in stated if not self.program.can_mention(one, self.program.first_step))

    def may_grow(self, horizon: int) -> bool:
        """Return whether bound and limit allow a step after ``horizon``."""
        return self.last(horizon + 1) > horizon

    def last(self, maximum: Optional[int] = None) -> int:
        """Return the least of bound, limit and ``maximum``; the current horizon if all are None."""
        ends = [end for end in (self.snapshot.bound, self._limit, maximum) if end is not None]
        return min(ends, default=self.horizon)

    def actions(self, first: int, last: int) -> List[clingo.Symbol]:
        """Return the possible actions of the cycles ``first`` to ``last`` that are not closed."""
        return self.grounding.actions(first, last)

    @property
    def first_actions(self) -> List[clingo.Symbol]:
        """The possible actions of the first cycle that was not closed when the program was grounded."""
        first = self.grounding.snapshot.step
        return self.actions(first, first)

    def ground(self, horizon: int) -> None:
        """Extend the grounding in pieces up to ``horizon``, or build a new one; raises StoppedError."""
        size = self.grounding.piece if self.grounding.grows else lambda: horizon
        for last in pieces(self.horizon + 1, horizon, size, self.is_stopped):
            if self.grounding.grows:
                self.grounding.grow_to(last)
            else:
                self.grounding = self._build(self.snapshot.with_horizon(last, self.program), last, self.is_stopped)

    # ---- Implementation ----------------------------------------------------------------------------------------------

    def _ask(self, question: Question) -> Reply:
        stopped = self.is_stopped
        if stopped():
            raise StoppedError
        self.ground(question.last)
        if stopped():
            raise StoppedError
        start = time.perf_counter()
        question = question._replace(asserted=self._asserted, given=[*self._executed, *question.given])
        reply = self.grounding.ask(question, stopped)
        self.seconds += time.perf_counter() - start
        if reply.satisfiable is None and stopped():
            raise StoppedError
        return reply
