"""An incremental solver that can continue from any history."""

from typing import Callable, Optional

from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.reactive_solver import ReactiveSolver
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.history import AcceptedUpdate, History
from rosoclingo.planning.question import Stop


class LoggedSolver:
    """Replays a history in an incremental solver; uses a new solver if the history was shortened.

    Attributes:
        log: the history.

    """

    def __init__(self, make: Callable[[], ReactiveSolver]) -> None:
        """Use solvers that ``make`` returns."""
        self._make, self._solver = make, make()
        self.log = self._read = History()

    @property
    def reached(self) -> int:
        """The last grounded step, also during a search."""
        return self._solver.reached

    def restore(self, log: History) -> None:
        """Continue from a history."""
        self.log = log

    def solve(self, stopped: Optional[Stop] = None, dropped: Optional[Stop] = None) -> SolveResult:
        """Search without an update."""
        return self._run(lambda solver: solver.solve(stopped, dropped), None)

    def update(
        self, update: StreamUpdate, stopped: Optional[Stop] = None, dropped: Optional[Stop] = None
    ) -> SolveResult:
        """Accept ``update`` and search for answers; raises like :class:`ReactiveSolver`."""
        return self._run(lambda solver: solver.update(update, stopped, dropped), update)

    def _run(self, search: Callable[[ReactiveSolver], SolveResult], update: Optional[StreamUpdate]) -> SolveResult:
        entries = self.log.entries_after(self._read)
        if entries is None:
            self._solver, self._read, entries = self._make(), History(), self.log.entries
        for one in entries:
            if isinstance(one, AcceptedUpdate):
                self._solver.take_again(one.update, one.horizon)
        self._read = self.log
        result = search(self._solver)
        self.log = self._read = self.log.with_entries(AcceptedUpdate(update, self._solver.horizon))
        return result
