"""A solver that runs in worker processes."""

from typing import Any, FrozenSet, Optional, Sequence

import clingo

from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.planning_solver import PlanningSolver
from rosoclingo.planning.question import Reply, Stop, never
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.protocol import WorkerReply
from rosoclingo.planning.workers.worker import WorkerRequest


class ProcessSolver(PlanningSolver):
    """Solves a reactive logic program under a stream of updates in a worker process.

    It has the methods of :class:`~rosoclingo.planning.solver.PlanSolver`. All of them raise DroppedError if the worker
    was killed; the history is unchanged then. A predicted update is answered without the worker. Not thread-safe.
    """

    def __init__(self, pool: WorkerPool) -> None:
        """Create a solver with an empty history that uses the workers of ``pool``; does not block."""
        super().__init__()
        self._pool, self._under_way = pool, lambda: pool.reached
        self._checkpoint: Optional[WorkerRequest] = None  # the last request for a checkpoint

    def prefetch(self, update: StreamUpdate, before: Sequence[StreamUpdate] = ()) -> bool:
        """Prefetch the answer to ``update``; return whether the standby worker does so. Does not block.

        If it follows predicted updates ``before`` it, the standby worker also shortens the plan.
        """
        log = self._log_after(before) if before else self.log
        return log is not None and self._pool.prefetch(WorkerRequest("search", (update, bool(before)), log))

    def has_prefetched(self, update: StreamUpdate, stopped: Optional[Stop] = None) -> bool:
        """Return whether the answer to ``update`` was prefetched; wait for it until ``stopped``."""
        return self._pool.has_prefetched(self._request("search", update, False), stopped or (lambda: True))

    def improve(self, stopped: Optional[Stop] = None) -> Optional[SolveResult]:
        """Search for a better plan; None after a stop, or if the search is exhausted. Raises like :meth:`update`.

        A stop does not wait for the worker.
        """
        if self.log.plan is None or self.log.plan.shortest:
            return None
        reply = self._pool.ask(self._request("improve"), stopped or never, idle=True)
        return None if reply.value is None else self._adopt_reply(reply)

    def checkpoint(self, stopped: Stop = never) -> None:
        """Insert a checkpoint that the worker computes.

        A stop does not wait for the worker. If the worker has no other command meanwhile, a later call inserts the
        checkpoint before the updates that were accepted since then.
        """
        request, later = self._checkpoint, None
        if request is not None and self._pool.has_begun(request):
            later = self.log.entries_after(request.log)
        if request is None or later is None:
            request, later = self._request("checkpoint"), []
        self._checkpoint = request
        log = self._pool.ask(request, stopped, idle=True).log
        self._replace_log(self.log if log is None else log.with_entries(*later))

    def inquire(
        self,
        update: StreamUpdate,
        assumable: FrozenSet[clingo.Symbol],
        disabled: FrozenSet[clingo.Symbol],
        stopped: Optional[Stop] = None,
    ) -> Reply:
        """Return whether ``update`` has an answer if the ``disabled`` facts do not hold; raises like :meth:`update`."""
        reply: Reply = self._pool.ask(self._request("inquire", update, assumable, disabled), stopped or never).value
        return reply

    def search(self, update: Optional[StreamUpdate], stopped: Stop) -> SolveResult:
        """Accept ``update``, if there is one, and search for answers; raises like :meth:`update`."""
        return self._adopt_reply(self._pool.ask(self._request("search", update, False), stopped))

    def _request(self, name: str, *arguments: Any) -> WorkerRequest:
        return WorkerRequest(name, arguments, self.log)

    def _adopt_reply(self, reply: WorkerReply) -> SolveResult:
        """Adopt the history and the answer in ``reply``; return the answer."""
        result: SolveResult = reply.value
        assert reply.log is not None
        self.log, self._answer = reply.log, (reply.log, result)
        return result
