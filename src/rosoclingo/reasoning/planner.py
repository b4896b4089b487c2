"""The solver as the core uses it: it closes the past, bounds the look ahead, and can go back by one update."""

from contextlib import nullcontext
from dataclasses import replace
from typing import Callable, ContextManager, FrozenSet, Iterable, Optional

from clingo import Symbol

from rosoclingo.oclingo import ReactiveSolver, SolveResult, Statement, StreamUpdate
from rosoclingo.oclingo.state import StreamState

#: Makes a solver that nothing was fed to yet.
SolverFactory = Callable[[], ReactiveSolver]

#: Entered around every search, with the solver; a node limits the time of the search there.
SearchGuard = Callable[[ReactiveSolver], ContextManager[object]]


def no_guard(_solver: ReactiveSolver) -> ContextManager[object]:
    """The search takes the time it takes."""
    return nullcontext()


class Planner:
    """A reactive solver that knows its state before the last update.

    ``lookahead`` is the greatest number of steps that the horizon may lie beyond the current cycle.
    """

    def __init__(self, make_solver: SolverFactory, lookahead: int, guard: SearchGuard = no_guard) -> None:
        self._make_solver = make_solver
        self._lookahead = lookahead
        self._guard = guard
        self._solver = make_solver()
        self._before = self._solver.snapshot()
        self._last: Optional[StreamUpdate] = None

    def solve(self) -> SolveResult:
        """Solve before any update."""
        return self._search(StreamUpdate(step=1), self._lookahead)

    def end_cycle(self, cycle: int, executed: Iterable[Symbol]) -> None:
        """``cycle`` is past: only the ``executed`` action atoms may ever be in a plan at it."""
        self._solver.close_cycle(cycle, executed)

    def update(self, update: StreamUpdate) -> SolveResult:
        """Feed an update, which names its step, and solve; raises SolverError, with nothing changed, when refused."""
        return self._feed(update, self._lookahead)

    def restarted(self, without: FrozenSet[Symbol] = frozenset()) -> "Planner":
        """A planner beside this one in the same state, less the facts ``without``, and with a short horizon again."""
        planner = Planner(self._make_solver, self._lookahead, self._guard)
        planner._solver.restore(_state_less(self._before, without))
        if self._last is not None:
            planner._feed(_update_less(self._last, without), 0)
        return planner

    def _feed(self, update: StreamUpdate, lookahead: int) -> SolveResult:
        before = self._solver.snapshot()
        result = self._search(update, lookahead)
        self._before, self._last = before, update
        return result

    def _search(self, update: StreamUpdate, lookahead: int) -> SolveResult:
        """Search with a bound, which is no part of the stream as it is told to others."""
        with self._guard(self._solver):
            return self._solver.update(replace(update, bound=lookahead))


def _update_less(update: StreamUpdate, without: FrozenSet[Symbol]) -> StreamUpdate:
    kept = (item for item in update.items if not (isinstance(item, Statement) and item.head in without))
    return replace(update, items=tuple(kept))


def _state_less(state: StreamState, without: FrozenSet[Symbol]) -> StreamState:
    less = state.copy()
    less.permanent = [statement for statement in less.permanent if statement.head not in without]
    less.waiting = [entry for entry in less.waiting if entry.statement.head not in without]
    return less
