"""The base class of planners, which work in this process or in a worker."""

from abc import ABC, abstractmethod
from dataclasses import replace
from typing import Callable, FrozenSet, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.history import AcceptedUpdate, History, Plan
from rosoclingo.planning.prediction import is_predicted
from rosoclingo.planning.question import Reply, Stop, never

LONG = 20
"""Number of updates after which a checkpoint is worthwhile, because every reader has to fold them."""


class PlanningSolver(ABC):
    """Solves a reactive logic program under a stream of updates; answers are plans.

    This base class keeps the history and answers predicted updates without a search. The solvers are
    :class:`~rosoclingo.planning.solver.PlanSolver` and
    :class:`~rosoclingo.planning.workers.process_solver.ProcessSolver`.

    Attributes:
        log: the history, which is the whole state of the solver.

    """

    def __init__(self) -> None:
        self.log = History()
        self._answer: Optional[Tuple[History, SolveResult]] = None  # the last answer and its history
        self._under_way: Callable[[], int] = lambda: 0  # the last step that the running search has grounded

    @property
    def horizon(self) -> int:
        """N, the last step that was searched."""
        return self.log.horizon

    @property
    def reached(self) -> int:
        """The last grounded step, also during a search."""
        return max(self.horizon, self._under_way())

    @property
    def step(self) -> int:
        """k, the step of the last update."""
        return self.log.step

    def restore(self, log: History) -> None:
        """Continue from another history, of this solver or of any other."""
        self.log = log

    def solve(self, stopped: Optional[Stop] = None) -> SolveResult:
        """Search without an update (before the first one: at horizon 1)."""
        return self.search(None, stopped or never)

    def update(self, update: StreamUpdate, stopped: Optional[Stop] = None) -> SolveResult:
        """Accept ``update`` and search for answers; extend the horizon until there is one or the bound is reached.

        A predicted update is answered without a search. If ``stopped`` ends the search, the update stays accepted.
        Raises SolverError if the update is refused and DroppedError if it is dropped; the history is unchanged then.
        """
        return self._accept_predicted(update) or self.search(update, stopped or never)

    @abstractmethod
    def search(self, update: Optional[StreamUpdate], stopped: Stop) -> SolveResult:
        """Accept ``update``, if there is one, and search for answers even if it is predicted."""

    def improve(self, stopped: Optional[Stop] = None) -> Optional[SolveResult]:
        """Search for a better plan; return None after a stop or if nothing is left to try."""
        return None

    def compact(self, stopped: Optional[Stop] = None) -> None:
        """Append a checkpoint if many updates followed the last one, unless stopped. Call it while the robot acts."""
        if self.log.length > LONG and self._known_answer is not None:
            self.checkpoint(stopped or never)

    def checkpoint(self, stopped: Stop = never) -> None:  # noqa: B027 optional
        """Append a checkpoint to the history, with past steps compacted if there are enough, unless stopped."""

    @abstractmethod
    def inquire(
        self,
        update: StreamUpdate,
        assumable: FrozenSet[clingo.Symbol],
        disabled: FrozenSet[clingo.Symbol],
        stopped: Optional[Stop] = None,
    ) -> Reply:
        """Return whether ``update`` has an answer if the ``disabled`` facts do not hold, otherwise the unsat core."""

    def prefetch(self, update: StreamUpdate, before: Sequence[StreamUpdate] = ()) -> bool:
        """Prefetch the answer to ``update``, in case it follows the updates ``before``; return whether this started.

        Solvers without workers never prefetch.
        """
        return False

    def has_prefetched(self, update: StreamUpdate, stopped: Optional[Stop] = None) -> bool:
        """Return whether the answer to the next update was prefetched; wait for it until ``stopped``."""
        return False

    def predicts(self, update: StreamUpdate) -> bool:
        """Return whether ``update``, as the next update, needs no search."""
        return self._log_after([update]) is not None

    def _adopt(self, result: SolveResult) -> None:
        """Adopt the plan in ``result``, the answer to the whole history."""
        self.log = self.log.adopt(Plan.from_result(result))
        self._answer = self.log, result

    @property
    def _known_answer(self) -> Optional[SolveResult]:
        """The answer to the whole history, None if it is not known."""
        return self._answer[1] if self._answer is not None and self._answer[0] is self.log else None

    def _replace_log(self, log: History) -> None:
        """Continue with an equivalent history, which has the same answer."""
        answer, self.log = self._known_answer, log
        self._answer = None if answer is None else (log, answer)

    def _log_after(self, updates: Sequence[StreamUpdate]) -> Optional[History]:
        """Return the history after ``updates`` if all of them are predicted; None if one needs a search."""
        answer, plan, log = self._known_answer, self.log.plan, self.log
        if answer is None or plan is None or not answer.predicted:
            return None
        for update in updates:
            if not is_predicted(plan, answer.predicted, log.step, update):
                return None
            log = log.with_entries(AcceptedUpdate(update, log.horizon, answered=True))
        return log

    def _accept_predicted(self, update: StreamUpdate) -> Optional[SolveResult]:
        """Accept ``update`` and return the answer if it is predicted; None if it needs a search."""
        log, result = self._log_after([update]), self._known_answer
        if log is None or result is None:
            return None
        self.log = log
        result = replace(
            result, step=self.step, warnings=update.warnings, statistics=dict.fromkeys(result.statistics, 0.0)
        )
        self._answer = log, result
        return result
