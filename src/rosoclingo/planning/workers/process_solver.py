"""A solver that works in worker processes."""

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, FrozenSet, List, Optional, Sequence

import clingo

from rosoclingo.oclingo.errors import NotReadyError
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.history import Checkpoint, Taken
from rosoclingo.planning.solver import LONG_PREDICTED, PredictingSolver
from rosoclingo.planning.strategies.probe import Verdict
from rosoclingo.planning.workers.child import Stopped
from rosoclingo.planning.workers.wire import (
    Message,
    question_to_message,
    result_from_message,
    verdict_from_message,
)
from rosoclingo.planning.workers.worker import Prefetch

if TYPE_CHECKING:
    from rosoclingo.planning.workers.pool import WorkerPool


class ProcessSolver(PredictingSolver):
    """Solves a reactive logic program under a stream of updates, in a worker process.

    The methods are those of :class:`~rosoclingo.planning.solver.PlanSolver`; not thread-safe.
    """

    def __init__(self, pool: "WorkerPool") -> None:
        """Make a solver that asks the workers of ``pool``, to which nothing has been fed; that does not wait."""
        super().__init__()
        self._pool, self._under_way = pool, lambda: pool.reached

    def solve(self, stopped: Optional[Stopped] = None) -> SolveResult:
        """Search without an update."""
        return self._search(None, stopped)

    def update(self, update: StreamUpdate, stopped: Optional[Stopped] = None) -> SolveResult:
        """Take ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError if the update as a whole can't be taken, DroppedError if the worker had to be ended; the
        history is then as it was before. An interrupted search leaves the update in force. What was predicted is
        answered at once, whatever the worker is at.
        """
        result = self._go_on(update) or self._search(update, stopped)
        return replace(result, warnings=update.warnings + result.warnings)

    def prepare(self, update: StreamUpdate, before: Sequence[StreamUpdate] = ()) -> bool:
        """Have the answer to ``update`` prefetched, should it come next; nothing waits for that.

        Or next after some ``before`` that are predicted: then there is time to shorten the plan. Tell whether that is
        done: the standby may be at something else, and then it has to be asked again.
        """
        log = self._log_after(before) if before else self.log
        return log is not None and self._pool.prefetch(Prefetch(log, update, improves=bool(before)))

    def has_prepared(self, update: StreamUpdate) -> bool:
        """Whether the answer to ``update`` is there, should it come next."""
        return self._pool.has_prefetched(Prefetch(self.log, update))

    def improve(self, stopped: Optional[Stopped] = None) -> Optional[SolveResult]:
        """Look for a shorter plan until there is one, ``stopped`` or nothing is left to try; raises as updates do.

        A stop is passed on, and not waited for.
        """
        if self.log.plan is None or self.log.plan.shortest:
            return None
        reply = self._ask_idly({"do": "improve"}, stopped)
        if not reply:
            return None
        result = result_from_message(reply)
        self._adopt(result)
        self._pool.came_to(self.log)
        return result

    def shorten_log(self, stopped: Optional[Stopped] = None) -> None:
        """Put a checkpoint at the end of the history, if it has grown long by what was predicted.

        The worker makes it, with what is over retired; a stop is passed on, and not waited for.
        """
        if self.log.length <= LONG_PREDICTED or self._known_answer is None:
            return
        reply = self._ask_idly({"do": "shorten"}, stopped)
        if reply:
            self._replace_log(self.log.checkpoint(Checkpoint(message=reply["checkpoint"])))
            self._pool.came_to(self.log)

    def inquire(
        self,
        update: StreamUpdate,
        doubted: FrozenSet[clingo.Symbol],
        untold: FrozenSet[clingo.Symbol],
        stopped: Optional[Stopped] = None,
    ) -> Verdict:
        """Tell whether ``update`` would have an answer, had ``untold`` never been told; raises as updates do."""
        question = question_to_message(update, doubted, untold)
        return verdict_from_message(self._pool.ask(self.log, question, stopped))

    def _ask_idly(self, command: Message, stopped: Optional[Stopped]) -> Message:
        """Return the reply to what leaves nothing behind but a better plan; an empty one after a stop."""
        with suppress(NotReadyError):
            return self._pool.ask(self.log, command, stopped, leaves=True)
        return {}

    def _search(self, update: Optional[StreamUpdate], stopped: Optional[Stopped]) -> SolveResult:
        results: List[SolveResult] = []
        for reply in self._pool.search(self.log, update, stopped):
            if "grounded" in reply:  # a search; a plan that was shortened later takes no entry
                self.log = self.log.then(Taken(None if results else update, reply["grounded"]))
            if reply.get("checkpoint") is not None:
                self.log = self.log.checkpoint(Checkpoint(message=reply["checkpoint"]))
            results.append(result_from_message(reply))
        better = [one for one in results if one.answers and one.horizon <= results[0].horizon]
        first, result = results[0], (better or results[:1])[-1]
        result = replace(result, warnings=first.warnings, statistics=first.statistics)
        self._adopt(result)
        self._pool.came_to(self.log)
        return result
