"""The solver as the core uses it: it closes the past, bounds the look ahead, and can go back by one update."""

from dataclasses import replace
from typing import Callable, FrozenSet, Iterable, NamedTuple, Optional

from clingo import Symbol

from rosoclingo.oclingo import (
    DroppedError,
    NotReadyError,
    SolveOutcome,
    SolveResult,
    StreamSolver,
    StreamUpdate,
    Volatile,
    commitment,
)

#: Makes a solver that nothing was fed to yet.
SolverFactory = Callable[[], StreamSolver]


#: Cycles that stay as they were fed, so that an observation can still be named as the reason of a failure.
RECENT = 10

#: Cycles after which even what an open request saw is over.
LONG_AGO = 150


class Halt(NamedTuple):
    """Why a search must end.

    ``disturbed`` tells that its result is of no use any more, since something has come that changes the question;
    otherwise it has taken too long.
    """

    why: str
    disturbed: bool = False


#: Called at the start of each search; what it returns is asked again and again during the search.
SearchWatch = Callable[[], Callable[[], Optional[Halt]]]


def unwatched() -> Callable[[], Optional[Halt]]:
    """The search takes the time it takes."""
    return lambda: None


class DisturbedError(Exception):
    """The search was left for something that has come; ``kept`` tells whether its update is in force."""

    def __init__(self, why: str, kept: bool) -> None:
        super().__init__(f"the search was left: {why}")
        self.kept = kept


class Planner:
    """A reactive solver that knows its state before the last update.

    ``lookahead`` is the greatest number of steps that the horizon may lie beyond the current cycle. Every search may
    raise DisturbedError, and DroppedError where it could be ended only by dropping the update.

    Attributes:
        ended_by: why the last search was ended, empty where it ended by itself.

    """

    def __init__(self, make_solver: SolverFactory, lookahead: int, watch: SearchWatch = unwatched) -> None:
        self._make_solver = make_solver
        self._lookahead = lookahead
        self._watch = watch
        self._solver = make_solver()
        self._before = self._solver.snapshot()
        self._last: Optional[StreamUpdate] = None
        self.ended_by = ""

    def solve(self) -> SolveResult:
        """Solve before any update."""
        return self._search(StreamUpdate(step=1), self._lookahead)

    def end_cycle(self, cycle: int, executed: Iterable[Symbol], since: int = 0) -> None:
        """``cycle`` is past: only the ``executed`` action atoms may ever be in a plan at it.

        ``since`` is the cycle of the oldest request that still matters. What lies well before it is over.
        """
        self._solver.close_cycle(cycle, executed)
        self._solver.forget_before(max(min(since, cycle - RECENT), cycle - LONG_AGO))

    def update(self, update: StreamUpdate) -> SolveResult:
        """Feed an update, which names its step, and solve; raises SolverError, with nothing changed, when refused."""
        return self._feed(update, self._lookahead)

    def take(self, update: StreamUpdate) -> SolveResult:
        """Feed an update without looking ahead; no answer means that none was found, there may be one."""
        result = self._feed(update, 0)
        unknown = result.outcome is SolveOutcome.UNSATISFIABLE and not result.permanent
        return replace(result, outcome=SolveOutcome.INTERRUPTED) if unknown else result

    def may_begin_with(self, action: Symbol, steps: int) -> bool:
        """Whether a plan of the present cycle and ``steps`` more holds ``action``; True where that takes too long."""
        update = StreamUpdate(self._solver.step, items=(Volatile(), commitment(action)))
        return self._search(update, steps).outcome is not SolveOutcome.UNSATISFIABLE

    def why_none(self, result: SolveResult) -> str:
        """Why the last search, with that ``result``, gave no plan."""
        if result.outcome is SolveOutcome.INTERRUPTED:
            return "no plan was found before the search was ended" + (f": {self.ended_by}" if self.ended_by else "")
        return f"there is no plan of at most {self._lookahead} steps"

    def restarted(self, without: FrozenSet[Symbol] = frozenset()) -> "Planner":
        """A planner beside this one in the same state, less the facts ``without``, and with a short horizon again."""
        planner = Planner(self._make_solver, self._lookahead, self._watch)
        planner._solver.restore(self._before.less(without))
        if self._last is not None:
            planner._feed(self._last.less(without), 0)
        return planner

    def _feed(self, update: StreamUpdate, lookahead: int) -> SolveResult:
        before = self._solver.snapshot()
        try:
            result = self._search(update, lookahead)
        except DisturbedError as disturbance:
            if disturbance.kept:
                self._before, self._last = before, update
            raise
        self._before, self._last = before, update
        return result

    def _search(self, update: StreamUpdate, lookahead: int) -> SolveResult:
        while True:
            try:
                return self._search_once(update, lookahead)
            except NotReadyError:  # the search's time has not begun
                continue

    def _search_once(self, update: StreamUpdate, lookahead: int) -> SolveResult:
        """Search with a bound, which is no part of the stream as it is told to others."""
        look, halt = self._watch(), None

        def stopped() -> bool:
            """Tell whether the search is to end; the first reason is kept."""
            nonlocal halt
            halt = halt or look()
            return halt is not None

        try:
            result = self._solver.update(replace(update, bound=lookahead), stopped)
        except DroppedError:
            self.ended_by = halt.why if halt else ""
            if halt and halt.disturbed:
                raise DisturbedError(halt.why, kept=False) from None
            raise
        interrupted = result.outcome is SolveOutcome.INTERRUPTED
        self.ended_by = halt.why if halt and interrupted else ""
        if halt and halt.disturbed and interrupted:
            raise DisturbedError(halt.why, kept=True)
        return result
