"""The solver as the core uses it: it closes the past, bounds the look into the future, and can start afresh."""

from contextlib import nullcontext
from typing import Callable, ContextManager, FrozenSet, Iterable, NamedTuple, Tuple

from clingo import Symbol

from rosoclingo.oclingo import ReactiveSolver, SolveResult, Statement, StreamUpdate

#: Makes a solver that nothing was fed to yet.
SolverFactory = Callable[[], ReactiveSolver]

#: Entered around every search, with the solver; a node limits the time of the search there.
SearchGuard = Callable[[ReactiveSolver], ContextManager[object]]


class EndedCycle(NamedTuple):
    """A cycle of the past and the action atoms executed in it."""

    cycle: int
    executed: FrozenSet[Symbol]


def no_guard(_solver: ReactiveSolver) -> ContextManager[object]:
    """The search takes the time it takes."""
    return nullcontext()


class Planner:
    """A reactive solver and its whole history.

    ``lookahead`` is the greatest number of steps that the horizon may lie beyond the current cycle. A planner made
    with a ``history`` feeds it together with its first update.
    """

    def __init__(
        self,
        make_solver: SolverFactory,
        lookahead: int,
        guard: SearchGuard = no_guard,
        history: Tuple[StreamUpdate, ...] = (),
        ended: Tuple[EndedCycle, ...] = (),
    ) -> None:
        self._make_solver = make_solver
        self._lookahead = lookahead
        self._guard = guard
        self._solver = make_solver()
        self._history = history
        self._backlog = tuple(item for update in history for item in update.items)
        self._ended: Tuple[EndedCycle, ...] = ()
        for past in ended:
            self.end_cycle(past.cycle, past.executed)

    def solve(self) -> SolveResult:
        """Solve before any update."""
        return self._search(StreamUpdate(step=1, bound=self._lookahead))

    def end_cycle(self, cycle: int, executed: Iterable[Symbol]) -> None:
        """``cycle`` is past: only the ``executed`` action atoms may ever be in a plan at it."""
        past = EndedCycle(cycle, frozenset(executed))
        self._ended += (past,)
        self._solver.close_cycle(past.cycle, past.executed)

    def update(self, update: StreamUpdate) -> SolveResult:
        """Feed an update, which names its step, and solve; raises SolverError, with nothing changed, when refused."""
        result = self._search(StreamUpdate(update.step, self._lookahead, self._backlog + update.items))
        self._backlog = ()
        self._history += (update,)
        return result

    def _search(self, update: StreamUpdate) -> SolveResult:
        with self._guard(self._solver):
            return self._solver.update(update)

    def restarted(self, without: FrozenSet[Symbol] = frozenset()) -> "Planner":
        """A planner with a fresh solver, so with a short horizon, and the same history less the facts ``without``."""
        history = tuple(_less(update, without) for update in self._history)
        return Planner(self._make_solver, self._lookahead, self._guard, history, self._ended)


def _less(update: StreamUpdate, without: FrozenSet[Symbol]) -> StreamUpdate:
    kept = (item for item in update.items if not (isinstance(item, Statement) and item.head in without))
    return StreamUpdate(update.step, update.bound, tuple(kept))
