"""What a solver in this process and one in a process of its own have in common."""

from typing import Any, Callable, FrozenSet, Iterable, Optional, Protocol

import clingo

from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.solver import SolveResult


class Snapshot(Protocol):
    """A state of a solver."""

    def less(self, facts: FrozenSet[clingo.Symbol]) -> "Snapshot":
        """Return the state that would be, had none of ``facts`` been told."""


class StreamSolver(Protocol):
    """Solves a reactive logic program under a stream of updates.

    See :class:`~rosoclingo.oclingo.solving.solver.ReactiveSolver` and
    :class:`~rosoclingo.oclingo.remote.process_solver.ProcessSolver`.
    """

    @property
    def horizon(self) -> int:
        """N, the last grounded step."""

    @property
    def step(self) -> int:
        """k, the step of the last update."""

    def update(self, update: StreamUpdate, stopped: Optional[Callable[[], bool]] = None) -> SolveResult:
        """Take ``update`` and search for answers until there is one, the bound is reached or ``stopped`` says so."""

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Fix the actions of ``cycle`` to those in ``executed``."""

    def forget_before(self, step: int) -> None:
        """Let the steps before ``step`` be over."""

    def snapshot(self) -> Any:
        """Return the present state, a :class:`Snapshot`, for :meth:`restore`."""

    def restore(self, state: Any) -> None:
        """Go to a state that :meth:`snapshot` gave."""
