"""The incremental solver as workers need it: it reads histories."""

from typing import Callable, Optional

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.reactive_solver import ReactiveSolver
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.history import History, Taken
from rosoclingo.planning.question import Stop


class LoggedSolver:
    """An incremental solver that goes on from any history; it begins again for one that it has not read the start of.

    Attributes:
        log: all that was taken.

    """

    def __init__(self, make: Callable[[], ReactiveSolver]) -> None:
        """Use a solver that ``make`` returns."""
        self._make, self._solver = make, make()
        self.log = self._read = History()

    @property
    def program(self) -> ReactiveProgram:
        """The reactive logic program."""
        return self._solver.program

    @property
    def horizon(self) -> int:
        """N, the last grounded step."""
        return self.log.horizon

    @property
    def reached(self) -> int:
        """The last step that is ground in the midst of a search."""
        return self._solver.reached

    def restore(self, log: History) -> None:
        """Go on from a history."""
        self.log = log

    def read(self) -> None:
        """Take what is new in the history, without a search."""
        entries = self.log.since(self._read)
        if entries is None:
            self._solver, entries = self._make(), self.log.entries
        for one in entries:
            if isinstance(one, Taken):
                self._solver.take_again(one.update, one.horizon)
        self._read = self.log

    def solve(self, stopped: Optional[Stop] = None, dropped: Optional[Stop] = None) -> SolveResult:
        """Search without an update."""
        return self._run(None, stopped, dropped)

    def update(
        self, update: StreamUpdate, stopped: Optional[Stop] = None, dropped: Optional[Stop] = None
    ) -> SolveResult:
        """Take ``update`` and search for answers; raises as :class:`ReactiveSolver` does."""
        return self._run(update, stopped, dropped)

    def _run(self, update: Optional[StreamUpdate], stopped: Optional[Stop], dropped: Optional[Stop]) -> SolveResult:
        self.read()
        if update is None:
            result = self._solver.solve(stopped, dropped)
        else:
            result = self._solver.update(update, stopped, dropped)
        self.log = self._read = self.log.then(Taken(update, self._solver.horizon))
        return result
