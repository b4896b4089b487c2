"""Runs strategies: sends their questions to a grounding, and polls for a stop."""

import time
from typing import Callable, List, Optional, TypeVar

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.grounding import PIECE, Grounding, pieces
from rosoclingo.planning.question import UNKNOWN, Question, Reply, Stop, StoppedError, Strategy
from rosoclingo.planning.snapshot import Snapshot

T = TypeVar("T")

Build = Callable[[Snapshot, int], Grounding]
"""Grounds the program with a snapshot up to a horizon."""


class StrategyRunner:
    """Runs strategies on a snapshot, and extends its grounding as their questions require.

    Attributes:
        program: the reactive logic program.
        snapshot: the snapshot of the history.
        step: the step of the last update.
        min_horizon: the least possible horizon of an answer.
        block: the number of steps to ground at once; 1 if further steps can invalidate an answer.
        grounding: the grounding.
        seconds: wall time spent in clingo's search so far.
        is_stopped: the stop function of the running strategy.

    """

    def __init__(
        self, program: ReactiveProgram, snapshot: Snapshot, build: Build, block: int, limit: Optional[int] = None
    ) -> None:
        """Ground the program up to the horizon of ``snapshot``; steps after ``limit`` are never grounded."""
        self.program, self.snapshot, self.block = program, snapshot, block
        self.step, self.min_horizon = snapshot.step, snapshot.min_horizon
        self._build, self._limit = build, limit
        self.grounding = build(snapshot, snapshot.horizon)
        self.seconds = 0.0
        self.is_stopped: Stop = lambda: False

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

    # ---- For strategies ----------------------------------------------------------------------------------------------

    @property
    def horizon(self) -> int:
        """The last grounded step."""
        return self.grounding.horizon

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

    def ground(self, horizon: int) -> None:
        """Extend the grounding in pieces up to ``horizon``, or build a new one; raises StoppedError."""
        for last in pieces(self.horizon + 1, horizon, PIECE if self.grounding.grows else horizon):
            if self.is_stopped():
                raise StoppedError
            if self.grounding.grows:
                self.grounding.grow_to(last)
            else:
                self.grounding = self._build(self.snapshot.with_horizon(last, self.program), last)

    # ---- Implementation ----------------------------------------------------------------------------------------------

    def _ask(self, question: Question) -> Reply:
        stopped = self.is_stopped
        if stopped():
            raise StoppedError
        if question.until is not None and question.until():
            return UNKNOWN
        self.ground(question.last)
        if stopped():
            raise StoppedError
        start = time.perf_counter()
        reply = self.grounding.ask(question, stopped)
        self.seconds += time.perf_counter() - start
        if reply.satisfiable is None and stopped():
            raise StoppedError
        return reply
