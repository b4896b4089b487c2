"""An incremental solver that can continue from any history."""

from typing import Any, Optional

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.reactive_solver import ReactiveSolver
from rosoclingo.oclingo.solving.results import Answer, SolveResult
from rosoclingo.planning.history import AcceptedUpdate, History
from rosoclingo.planning.question import Stop


class LoggedSolver:
    """Replays a history in an incremental solver; starts a new solver if the history does not continue the last one.

    Attributes:
        log: the history.

    """

    def __init__(self, program: ReactiveProgram, dropped: Stop, **options: Any) -> None:
        """Create solvers with ``options``; for ``dropped`` see :meth:`ReactiveSolver.update`."""
        self._program, self._dropped, self._options = program, dropped, options
        self._solver = ReactiveSolver(program, **options)
        self.log = self._read = History()

    @property
    def reached(self) -> int:
        """The last grounded step, also during a search."""
        return self._solver.reached

    @staticmethod
    def recent(answer: Answer) -> Answer:
        """Return ``answer``; this solver keeps the atoms of old cycles."""
        return answer

    def restore(self, log: History) -> None:
        """Continue from the history ``log``."""
        self.log = log

    def search(self, update: Optional[StreamUpdate], stopped: Stop) -> SolveResult:
        """Accept ``update``, if there is one, and search for answers; raises like :class:`ReactiveSolver`."""
        entries = self.log.entries_after(self._read)
        if entries is None:
            self._solver, self._read = ReactiveSolver(self._program, **self._options), History()
            entries = self.log.entries
        for one in entries:
            if isinstance(one, AcceptedUpdate):
                self._solver.reapply(one.update, one.horizon)
        self._read = self.log
        solver = self._solver
        ways = stopped, self._dropped
        result = solver.solve(*ways) if update is None else solver.update(update, *ways)
        self.log = self._read = self.log.with_entries(AcceptedUpdate(update, solver.horizon))
        return result
