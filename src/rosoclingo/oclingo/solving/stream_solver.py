"""The interface of a solver of streams."""

from typing import Callable, Optional, Protocol

from rosoclingo.oclingo.errors import SolverError
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


def check_horizon_limit(update: Optional[StreamUpdate], horizon: int, limit: Optional[int]) -> None:
    """Raise SolverError if the step of ``update``, or ``horizon`` without one, is beyond ``limit``."""
    step = horizon if update is None or update.step is None else update.step
    if limit is not None and step > limit:
        raise SolverError(f"step {step} is beyond the horizon limit {limit}; raise the limit or send a lower step")
