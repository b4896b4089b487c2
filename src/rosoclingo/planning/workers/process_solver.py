"""A solver that works in worker processes."""

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, FrozenSet, Optional, Sequence

import clingo

from rosoclingo.oclingo.errors import NotReadyError
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.history import History, Plan, entry_from_message
from rosoclingo.planning.planning_solver import LONG_PREDICTED, PlanningSolver
from rosoclingo.planning.question import Stop
from rosoclingo.planning.strategies.probe import Verdict
from rosoclingo.planning.text import Message, symbols_from_text, symbols_to_text
from rosoclingo.planning.workers.wire import result_from_message
from rosoclingo.planning.workers.worker import Search

if TYPE_CHECKING:
    from rosoclingo.planning.workers.pool import WorkerPool


class ProcessSolver(PlanningSolver):
    """Solves a reactive logic program under a stream of updates, in a worker process.

    The methods are those of :class:`~rosoclingo.planning.solver.PlanSolver`; not thread-safe.
    """

    def __init__(self, pool: "WorkerPool") -> None:
        """Make a solver with an empty history that asks the workers of ``pool``; that does not wait."""
        super().__init__()
        self._pool, self._under_way = pool, lambda: pool.reached

    def solve(self, stopped: Optional[Stop] = None) -> SolveResult:
        """Search without an update."""
        return self._search(None, stopped)

    def update(self, update: StreamUpdate, stopped: Optional[Stop] = None) -> SolveResult:
        """Accept ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError if the update is refused, DroppedError if the worker had to be killed; the history is then
        as it was before. An interrupted search leaves the update in force. A predicted update is answered at once,
        whatever the worker does.
        """
        result = self._accept_predicted(update) or self._search(update, stopped)
        return replace(result, warnings=update.warnings + result.warnings)

    def prefetch(self, update: StreamUpdate, before: Sequence[StreamUpdate] = ()) -> bool:
        """Have the answer to ``update`` prefetched, should it come next; nothing waits for that.

        Or after some updates ``before`` that are predicted: then there is time to shorten the plan. Return whether the
        standby does so.
        """
        log = self._log_after(before) if before else self.log
        return log is not None and self._pool.prefetch(Search(log, update, improves=bool(before)))

    def has_prefetched(self, update: StreamUpdate) -> bool:
        """Return whether the answer to ``update`` is there, should it come next."""
        return self._pool.has_prefetched(Search(self.log, update))

    def improve(self, stopped: Optional[Stop] = None) -> Optional[SolveResult]:
        """Look for a shorter plan until there is one, ``stopped`` or nothing is left to try; raises as updates do.

        A stop does not wait for the worker.
        """
        if self.log.plan is None or self.log.plan.shortest:
            return None
        reply = self._ask_idly("improve", stopped)
        return self._answered(reply) if "result" in reply else None

    def compact(self, stopped: Optional[Stop] = None) -> None:
        """Put a checkpoint at the end of the history, if it has grown long by predicted updates.

        The worker makes it, with steps that are over compacted; a stop does not wait for it.
        """
        if self.log.length <= LONG_PREDICTED or self._known_answer is None:
            return
        reply = self._ask_idly("shorten", stopped)
        if reply:
            self._replace_log(self._log_after_reply(reply))

    def inquire(
        self,
        update: StreamUpdate,
        assumable: FrozenSet[clingo.Symbol],
        disabled: FrozenSet[clingo.Symbol],
        stopped: Optional[Stop] = None,
    ) -> Verdict:
        """Return whether ``update`` would have an answer without the facts ``disabled``; raises as updates do."""
        facts = {"assumable": symbols_to_text(sorted(assumable)), "disabled": symbols_to_text(sorted(disabled))}
        reply = self._pool.ask({"do": "inquire", "update": str(update), **facts}, self.log, stopped)
        return Verdict(reply["satisfiable"], symbols_from_text(reply["core"]))

    def _ask_idly(self, do: str, stopped: Optional[Stop]) -> Message:
        """Return the reply to a command that only improves what there is; an empty one after a stop."""
        with suppress(NotReadyError):
            return self._pool.ask({"do": do}, self.log, stopped, idly=True)
        return {}

    def _search(self, update: Optional[StreamUpdate], stopped: Optional[Stop]) -> SolveResult:
        return self._answered(self._pool.search(Search(self.log, update), stopped))

    def _answered(self, reply: Message) -> SolveResult:
        """Continue with the history and the answer in ``reply``."""
        result, reported = result_from_message(reply["result"]), self._pool.remarks
        remarks = [one for one in reply["remarks"] if one not in reported]
        reported.update(remarks)
        result = replace(result, warnings=(*result.warnings, *remarks))
        log = self._log_after_reply(reply)
        if log.plan is not None:  # that of a prefetched answer may have begun with an earlier plan
            log = log.adopt(Plan.from_result(result))
        self.log, self._answer = log, (log, result)
        return result

    def _log_after_reply(self, reply: Message) -> History:
        """Return the history after a reply; a prefetched one began with another object for the same history."""
        if reply["start"] is self.log:
            log: History = reply["log"]
            return log
        return self.log.with_entries(*map(entry_from_message, reply["entries"])).cut()
