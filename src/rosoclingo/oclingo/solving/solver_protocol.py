"""What a solver of a stream is asked, wherever it works."""

from typing import TYPE_CHECKING, Callable, FrozenSet, Iterable, Optional, Protocol, Sequence

import clingo

from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.inquiry import Verdict
from rosoclingo.oclingo.solving.stream_log import StreamLog

if TYPE_CHECKING:
    from rosoclingo.oclingo.solving.solver import SolveResult


class StreamSolver(Protocol):
    """Solves a reactive logic program under a stream of updates.

    See :class:`~rosoclingo.oclingo.solving.solver.ReactiveSolver` and
    :class:`~rosoclingo.oclingo.remote.process_solver.ProcessSolver`.
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

    def update(self, update: StreamUpdate, stopped: Optional[Callable[[], bool]] = None) -> "SolveResult":
        """Take ``update`` and search for answers until there is one, the bound is reached or ``stopped`` says so."""

    def improve(self, stopped: Optional[Callable[[], bool]] = None) -> "Optional[SolveResult]":
        """Look for a shorter plan until there is one, ``stopped`` says so or nothing is left to try."""

    def prepare(self, update: StreamUpdate, before: Sequence[StreamUpdate] = ()) -> bool:
        """Have the answer to ``update`` prepared, should it come after those ``before``; tell whether that is done."""

    def has_prepared(self, update: StreamUpdate) -> bool:
        """Whether the answer to ``update`` is there, should it come next."""

    def shorten_log(self, stopped: Optional[Callable[[], bool]] = None) -> None:
        """Put a checkpoint at the end of a log that has grown long, unless ``stopped`` says so before."""

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Fix the actions of ``cycle`` to those in ``executed``."""

    def forget_before(self, step: int) -> None:
        """Let the steps before ``step`` be over."""

    @property
    def log(self) -> StreamLog:
        """All that was taken, from which the state follows."""

    def restore(self, log: StreamLog) -> None:
        """Go on from a log: an earlier one, or another solver's."""

    def inquire(
        self,
        update: StreamUpdate,
        doubted: FrozenSet[clingo.Symbol],
        untold: FrozenSet[clingo.Symbol],
        stopped: Optional[Callable[[], bool]] = None,
    ) -> Verdict:
        """Tell whether there would be an answer after ``update``, had the facts ``untold`` not been told."""
