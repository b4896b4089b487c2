"""The one loop that asks a grounding what strategies want to know, and the one way to stop it."""

import math
import time
from typing import Callable, Iterator, List, Optional, TypeVar

import clingo

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.grounding import PIECE, Grounding
from rosoclingo.planning.question import UNKNOWN, Question, Reply, Stop, StoppedError, Strategy
from rosoclingo.planning.snapshot import Snapshot

T = TypeVar("T")

PIECE_ATOMS = 250_000
"""About so many atoms are ground between two looks at the stop: each call of clingo goes through all there are."""

Build = Callable[[Snapshot, int], Grounding]
"""Grounds the program with a snapshot up to a horizon."""


class Asking:
    """A snapshot, its grounding, and what strategies may know of both.

    Attributes:
        program: the reactive logic program.
        snapshot: what is in force.
        block: steps to grow by at once; 1 if an answer may not outlive further steps.
        seconds: wall time spent in clingo's search so far.
        is_stopped: whether the strategy at work is to end.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        snapshot: Snapshot,
        build: Build,
        block: int,
        limit: Optional[int] = None,
    ) -> None:
        """Prepare to ask a grounding that is built when there is a question; ``limit`` is the last step of all."""
        self.program, self.snapshot, self.block = program, snapshot, block
        self._build, self._limit = build, limit
        self._grounding: Optional[Grounding] = None
        self.seconds = 0.0
        self.is_stopped: Stop = lambda: False

    def run(self, strategy: Strategy[T], stopped: Stop) -> T:
        """Ask what the ``strategy`` wants to know; raises :class:`StoppedError` if it has found nothing by then."""
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
            found: T = end.value
            return found

    # ---- What strategies may know ------------------------------------------------------------------------------------

    @property
    def grounding(self) -> Optional[Grounding]:
        """The grounding, None if nothing was asked."""
        return self._grounding

    def ground(self) -> Grounding:
        """Return the grounding, which is built if there is none."""
        return self._at_least(self.horizon)

    @property
    def step(self) -> int:
        """The step of the last update."""
        return self.snapshot.step

    @property
    def first(self) -> int:
        """The least horizon that an answer may have."""
        return self.snapshot.settled

    @property
    def horizon(self) -> int:
        """The last step that is ground, or will be with the first question."""
        return self.snapshot.horizon if self._grounding is None else self._grounding.horizon

    @property
    def may_grow(self) -> bool:
        """Whether bound and limit allow another step."""
        return self.last(self.horizon + 1) > self.horizon

    def last(self, most: Optional[int] = None) -> int:
        """Return the least of bound, limit and ``most``; the present horizon if there is none of them."""
        ends = [end for end in (self.snapshot.bound, self._limit, most) if end is not None]
        return min(ends, default=self.horizon)

    def actions(self, first: int, last: int, horizon: int = 0) -> List[clingo.Symbol]:
        """Return the actions of the cycles ``first`` to ``last``, as far as these are not closed.

        The program is ground up to ``horizon`` before, if it is not yet.
        """
        return self._at_least(max(horizon, self.horizon)).actions(first, last)

    def claimed_steps(self) -> int:
        """Return how many steps the program claims that a plan takes at least; 0 for no claim."""
        return self._at_least(self.horizon).claimed_steps()

    # ---- Asking ------------------------------------------------------------------------------------------------------

    def _ask(self, question: Question) -> Reply:
        stopped = self.is_stopped
        if stopped():
            raise StoppedError
        if question.until is not None and question.until():
            return UNKNOWN
        for last in self._ends(question.last):
            self._at_least(last)
            if stopped():
                raise StoppedError
        grounding, start = self._at_least(question.last), time.perf_counter()
        reply = grounding.ask(question, stopped)
        self.seconds += time.perf_counter() - start
        if reply.satisfiable is None and stopped():
            raise StoppedError
        return reply

    def _ends(self, last: int) -> Iterator[int]:
        """Yield the horizons to grow to, up to ``last``: pieces of even size."""
        while self._grounding is None or self._grounding.horizon < last:
            if self._grounding is None:
                yield self.snapshot.horizon
                continue
            rest = last - self._grounding.horizon
            number = round(rest / max(PIECE, PIECE_ATOMS // self._grounding.atoms_per_step))
            yield last if self._grounding.is_cyclic else self._grounding.horizon + math.ceil(rest / max(1, number))

    def _at_least(self, horizon: int) -> Grounding:
        """Return a grounding up to ``horizon`` at least."""
        grounding = self._grounding
        if grounding is None:
            grounding = self._built(max(horizon, self.snapshot.horizon))
        elif grounding.horizon < horizon:
            grounding = self._grown(grounding, horizon)
        self._grounding = grounding
        return grounding

    def _grown(self, grounding: Grounding, horizon: int) -> Grounding:
        """Return a grounding that has grown, or one built in its place.

        clingo takes rules that define the same atom at several steps, or that close a loop, only together.
        """
        if not grounding.is_cyclic:
            try:
                grounding.grow_to(horizon)
                return grounding
            except DroppedError:
                raise
            except SolverError:
                self._grounding = None  # a fault of another kind shows again
        return self._built(horizon)

    def _built(self, horizon: int) -> Grounding:
        """Return a new grounding, with what the program forgets by ``horizon`` as if it had grown to it."""
        return self._build(self.snapshot.searched(horizon, self.program), horizon)
