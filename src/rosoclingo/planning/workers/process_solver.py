"""A solver that runs in worker processes."""

from contextlib import suppress
from dataclasses import replace
from typing import FrozenSet, Optional, Sequence

import clingo

from rosoclingo.oclingo.errors import NotReadyError
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.history import History, Plan, entry_from_message
from rosoclingo.planning.planning_solver import LONG_PREDICTED, PlanningSolver
from rosoclingo.planning.question import Reply, Stop
from rosoclingo.planning.text import Message, symbols_from_text, symbols_to_text
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.wire import result_from_message
from rosoclingo.planning.workers.worker import Search


class ProcessSolver(PlanningSolver):
    """Solves a reactive logic program under a stream of updates in a worker process.

    It has the methods of :class:`~rosoclingo.planning.solver.PlanSolver`. Not thread-safe.
    """

    def __init__(self, pool: WorkerPool) -> None:
        """Create a solver with an empty history that uses the workers of ``pool``; does not block."""
        super().__init__()
        self._pool, self._under_way = pool, lambda: pool.reached

    def solve(self, stopped: Optional[Stop] = None) -> SolveResult:
        """Search without an update."""
        return self._search(None, stopped)

    def update(self, update: StreamUpdate, stopped: Optional[Stop] = None) -> SolveResult:
        """Accept ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError if the update is refused, and DroppedError if the worker was killed; the history is unchanged
        then. After an interrupted search the update stays accepted. A predicted update is answered without the worker.
        """
        result = self._accept_predicted(update) or self._search(update, stopped)
        return replace(result, warnings=update.warnings + result.warnings)

    def prefetch(self, update: StreamUpdate, before: Sequence[StreamUpdate] = ()) -> bool:
        """Prefetch the answer to ``update``; return whether the standby worker does so. Does not block.

        Predicted updates can come ``before`` it: then the standby worker also shortens the plan.
        """
        log = self._log_after(before) if before else self.log
        return log is not None and self._pool.prefetch(Search(log, update, improves=bool(before)))

    def has_prefetched(self, update: StreamUpdate, stopped: Optional[Stop] = None) -> bool:
        """Return whether the answer to ``update`` was prefetched; wait for it until ``stopped``."""
        return self._pool.has_prefetched(Search(self.log, update), stopped)

    def improve(self, stopped: Optional[Stop] = None) -> Optional[SolveResult]:
        """Search for a better plan; None after a stop, or if the search is exhausted. Raises like :meth:`update`.

        A stop does not wait for the worker.
        """
        if self.log.plan is None or self.log.plan.shortest:
            return None
        reply = self._ask_idle("improve", stopped)
        return self._answered(reply) if "result" in reply else None

    def compact(self, stopped: Optional[Stop] = None) -> None:
        """Append a checkpoint if many predicted updates have followed the last one.

        The worker computes it, with past steps compacted. A stop does not wait for the worker.
        """
        if self.log.length <= LONG_PREDICTED or self._known_answer is None:
            return
        reply = self._ask_idle("shorten", stopped)
        if reply:
            self._replace_log(self._log_after_reply(reply))

    def inquire(
        self,
        update: StreamUpdate,
        assumable: FrozenSet[clingo.Symbol],
        disabled: FrozenSet[clingo.Symbol],
        stopped: Optional[Stop] = None,
    ) -> Reply:
        """Return whether ``update`` has an answer without the ``disabled`` facts; raises like :meth:`update`."""
        facts = {"assumable": symbols_to_text(sorted(assumable)), "disabled": symbols_to_text(sorted(disabled))}
        reply = self._pool.ask({"do": "inquire", "update": str(update), **facts}, self.log, stopped)
        return Reply(reply["satisfiable"], core=symbols_from_text(reply["core"]))

    def _ask_idle(self, do: str, stopped: Optional[Stop]) -> Message:
        """Return the reply to an optional command; an empty reply after a stop."""
        with suppress(NotReadyError):
            return self._pool.ask({"do": do}, self.log, stopped, idle=True)
        return {}

    def _search(self, update: Optional[StreamUpdate], stopped: Optional[Stop]) -> SolveResult:
        return self._answered(self._pool.search(Search(self.log, update), stopped))

    def _answered(self, reply: Message) -> SolveResult:
        """Adopt the history and the answer in ``reply``; return the answer."""
        result, reported = result_from_message(reply["result"]), self._pool.remarks
        remarks = [one for one in reply["remarks"] if one not in reported]
        reported.update(remarks)
        result = replace(result, warnings=(*result.warnings, *remarks))
        log = self._log_after_reply(reply)
        if log.plan is not None:  # a prefetched answer can result from an earlier plan
            log = log.adopt(Plan.from_result(result))
        self.log, self._answer = log, (log, result)
        return result

    def _log_after_reply(self, reply: Message) -> History:
        """Return the history after a reply; a prefetched search can have started from an equal history."""
        if reply["start"] is self.log:
            log: History = reply["log"]
            return log
        return self.log.with_entries(*map(entry_from_message, reply["entries"])).cut()
