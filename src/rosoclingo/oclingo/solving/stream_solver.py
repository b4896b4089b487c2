"""What a solver of a stream is asked, wherever it works."""

from typing import Callable, Optional, Protocol

from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveResult


class StreamSolver(Protocol):
    """Solves a reactive logic program under a stream of updates.

    See :class:`~rosoclingo.oclingo.solving.reactive_solver.ReactiveSolver` and
    :class:`~rosoclingo.planning.solver.PlanSolver`.
    """

    @property
    def horizon(self) -> int:
        """N, the last grounded step."""

    @property
    def reached(self) -> int:
        """The last step that is ground in the midst of a search."""

    @property
    def step(self) -> int:
        """k, the step of the last update."""

    def solve(self, stopped: Optional[Callable[[], bool]] = None) -> SolveResult:
        """Search without an update."""

    def update(self, update: StreamUpdate, stopped: Optional[Callable[[], bool]] = None) -> SolveResult:
        """Take ``update`` and search for answers until there is one, the bound is reached or ``stopped`` says so."""
