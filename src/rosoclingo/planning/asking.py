"""The loop that runs a strategy: it sends the questions to a grounding and polls for a stop."""

import time
from typing import Callable, List, Optional, TypeVar

import clingo

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.grounding import PIECE, Grounding, pieces
from rosoclingo.planning.question import UNKNOWN, Question, Reply, Stop, StoppedError, Strategy
from rosoclingo.planning.snapshot import Snapshot

T = TypeVar("T")

Build = Callable[[Snapshot, int], Grounding]
"""Grounds the program with a snapshot up to a horizon."""


class Asking:
    """A snapshot and its grounding, which is built and extended as questions need it.

    Attributes:
        program: the reactive logic program.
        snapshot: the snapshot of the history.
        block: the number of steps to ground at once; 1 if further steps can invalidate an answer.
        grounding: the grounding, None before the first question.
        seconds: wall time spent in clingo's search so far.
        is_stopped: the stop of the running strategy.

    """

    def __init__(
        self, program: ReactiveProgram, snapshot: Snapshot, build: Build, block: int, limit: Optional[int] = None
    ) -> None:
        """Prepare for questions without grounding anything; no step after ``limit`` is ever ground."""
        self.program, self.snapshot, self.block = program, snapshot, block
        self._build, self._limit = build, limit
        self.grounding: Optional[Grounding] = None
        self.seconds = 0.0
        self.is_stopped: Stop = lambda: False

    def run(self, strategy: Strategy[T], stopped: Stop) -> T:
        """Return the result of ``strategy``; raises :class:`StoppedError` if it has none at the stop."""
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
    def step(self) -> int:
        """The step of the last update."""
        return self.snapshot.step

    @property
    def min_horizon(self) -> int:
        """The least possible horizon of an answer."""
        return self.snapshot.min_horizon

    @property
    def horizon(self) -> int:
        """The last step that is ground, or that the first question will ground."""
        return self.snapshot.horizon if self.grounding is None else self.grounding.horizon

    def may_grow(self, horizon: int) -> bool:
        """Return whether bound and limit allow a step after ``horizon``."""
        return self.last(horizon + 1) > horizon

    def last(self, most: Optional[int] = None) -> int:
        """Return the least of bound, limit and ``most``; the current horizon if all are None."""
        ends = [end for end in (self.snapshot.bound, self._limit, most) if end is not None]
        return min(ends, default=self.horizon)

    def actions(self, first: int, last: int) -> List[clingo.Symbol]:
        """Return the possible actions of the cycles ``first`` to ``last`` that are not closed."""
        return self.ground().actions(first, last)

    def ground(self, horizon: int = 0) -> Grounding:
        """Return the grounding with all steps up to ``horizon``; build it or extend it in pieces if necessary."""
        if self.grounding is None:
            self.grounding = self._new_grounding(self.snapshot.horizon)
        for last in pieces(self.grounding.horizon + 1, horizon, horizon if self.grounding.is_cyclic else PIECE):
            if self.is_stopped():
                raise StoppedError
            self.grounding = self._extended(self.grounding, last)
        return self.grounding

    # ---- Implementation ----------------------------------------------------------------------------------------------

    def _ask(self, question: Question) -> Reply:
        stopped = self.is_stopped
        if stopped():
            raise StoppedError
        if question.until is not None and question.until():
            return UNKNOWN
        grounding = self.ground(question.last)
        if stopped():
            raise StoppedError
        start = time.perf_counter()
        reply = grounding.ask(question, stopped)
        self.seconds += time.perf_counter() - start
        if reply.satisfiable is None and stopped():
            raise StoppedError
        return reply

    def _extended(self, grounding: Grounding, horizon: int) -> Grounding:
        """Return the extended grounding, or a new one if it cannot grow.

        Rules that define the same atom at several steps, or that close a loop, have to be ground in one call of clingo.
        """
        if not grounding.is_cyclic:
            try:
                grounding.grow_to(horizon)
                return grounding
            except DroppedError:
                raise
            except SolverError:
                pass  # any other error occurs again
        return self._new_grounding(horizon)

    def _new_grounding(self, horizon: int) -> Grounding:
        """Return a new grounding that forgets the same externals as one that has grown to ``horizon``."""
        return self._build(self.snapshot.with_horizon(horizon, self.program), horizon)
