"""The interface of both stream solvers."""

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
        """The last grounded step during a search."""

    @property
    def step(self) -> int:
        """k, the step of the last update."""

    def solve(self, stopped: Optional[Callable[[], bool]] = None) -> SolveResult:
        """Search without an update."""

    def update(self, update: StreamUpdate, stopped: Optional[Callable[[], bool]] = None) -> SolveResult:
        """Accept ``update`` and search until there is an answer, the bound is reached or ``stopped`` returns true."""


def check_horizon_limit(update: Optional[StreamUpdate], horizon: int, limit: Optional[int]) -> None:
    """Raise SolverError if the step of ``update``, or ``horizon`` without one, is beyond ``limit``."""
    step = horizon if update is None or update.step is None else update.step
    if limit is not None and step > limit:
        raise SolverError(f"step {step} is beyond the horizon limit {limit}; raise the limit or send a lower step")
