"""The interface of a solver of plans, in this process or in a worker."""

from typing import Callable, FrozenSet, Optional, Protocol, Sequence

import clingo

from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.oclingo.solving.stream_solver import StreamSolver
from rosoclingo.planning.history import History
from rosoclingo.planning.strategies.probe import Verdict


class PlanningSolver(StreamSolver, Protocol):
    """Solves a reactive logic program under a stream of updates; answers are plans.

    See :class:`~rosoclingo.planning.solver.PlanSolver` and
    :class:`~rosoclingo.planning.workers.process_solver.ProcessSolver`.
    """

    @property
    def log(self) -> History:
        """All that was taken, from which all else follows."""

    def restore(self, log: History) -> None:
        """Go on from a history: an earlier one, or another solver's."""

    def improve(self, stopped: Optional[Callable[[], bool]] = None) -> Optional[SolveResult]:
        """Look for a shorter plan until there is one, ``stopped`` says so or nothing is left to try."""

    def prepare(self, update: StreamUpdate, before: Sequence[StreamUpdate] = ()) -> bool:
        """Have the answer to ``update`` prepared, should it come after those ``before``; tell whether that is done."""

    def has_prepared(self, update: StreamUpdate) -> bool:
        """Whether the answer to ``update`` is there, should it come next."""

    def shorten_log(self, stopped: Optional[Callable[[], bool]] = None) -> None:
        """Put a checkpoint at the end of a history that has grown long, unless ``stopped`` says so before."""

    def inquire(
        self,
        update: StreamUpdate,
        assumable: FrozenSet[clingo.Symbol],
        disabled: FrozenSet[clingo.Symbol],
        stopped: Optional[Callable[[], bool]] = None,
    ) -> Verdict:
        """Tell whether there would be an answer after ``update``, had the facts ``disabled`` not been told."""
