"""A reactive solver that works in a child process."""

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, FrozenSet, List, Optional, Sequence

import clingo

from rosoclingo.oclingo.errors import NotReadyError
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.remote.child import Stopped
from rosoclingo.oclingo.remote.preparation import Subject
from rosoclingo.oclingo.remote.wire import (
    Message,
    plan_to_message,
    question_to_message,
    result_from_message,
    verdict_from_message,
)
from rosoclingo.oclingo.solving.inquiry import Verdict
from rosoclingo.oclingo.solving.solver import FORESEEN_LOG, ForeseeingSolver, SolveResult
from rosoclingo.oclingo.solving.stream_log import Checkpoint, Taken

if TYPE_CHECKING:
    from rosoclingo.oclingo.remote.solver_process import SolverProcess


class ProcessSolver(ForeseeingSolver):
    """Solves a reactive logic program under a stream of updates, in a child process.

    The methods are those of :class:`~rosoclingo.oclingo.solving.solver.ReactiveSolver`; not thread-safe.
    """

    def __init__(self, process: "SolverProcess") -> None:
        """Make a solver in ``process``, to which nothing has been fed; that does not wait for the process."""
        super().__init__()
        self._process, self._under_way = process, lambda: process.reached
        self._place = process.place()

    def solve(self, stopped: Optional[Stopped] = None) -> SolveResult:
        """Search without an update."""
        return self._search(None, stopped)

    def update(self, update: StreamUpdate, stopped: Optional[Stopped] = None) -> SolveResult:
        """Take ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError where the update as a whole can't be taken, DroppedError where the child had to be ended;
        the log is then as it was before. An interrupted search leaves the update in force. What was foreseen is
        answered at once, whatever the child is at, which takes it while the caller goes on.
        """
        result = self._go_on(update)
        if result is not None:
            self._process.follow(self._place, self._log)
        else:
            result = self._search(update, stopped)
        return replace(result, warnings=update.warnings + result.warnings)

    def prepare(self, update: StreamUpdate, before: Sequence[StreamUpdate] = ()) -> bool:
        """Have the answer to ``update`` prepared, should it come next; nothing waits for that.

        Or next after some ``before`` that are foreseen: then there is time to shorten the plan. Tell whether it is
        prepared now: the child that is kept ready may be at something else, and then it has to be asked again.
        """
        log = self._log_after(before) if before else self._log
        if log is None:
            return False
        return self._process.prepare(Subject(self._place, log, update, log.plan, improves=bool(before)))

    def has_prepared(self, update: StreamUpdate) -> bool:
        """Whether the answer to ``update`` is there, should it come next."""
        return self._process.has_prepared(Subject(self._place, self._log, update, None))

    def improve(self, stopped: Optional[Stopped] = None) -> Optional[SolveResult]:
        """Look for a shorter plan until there is one, ``stopped`` or nothing is left to try; raises as updates do.

        A stop is passed on, and not waited for.
        """
        if self._log.plan is None or self._log.plan.shortest:
            return None
        command, reply = {"do": "improve", "plan": plan_to_message(self._log.plan)}, {}
        with suppress(NotReadyError):
            reply = self._process.have(self._place, self._log, command, stopped, leaves=True)
        if not reply:
            return None
        result = result_from_message(reply)
        self._log.plan = result.plan
        self._has_answered(result)
        return result

    def shorten_log(self, stopped: Optional[Stopped] = None) -> None:
        """Put a checkpoint at the end of the log, where it has grown long by what was foreseen.

        The child makes it, with what is over retired; a stop is passed on, and not waited for.
        """
        if self._log.length <= FORESEEN_LOG or self._known_answer is None:
            return
        reply: Message = {}
        with suppress(NotReadyError):
            reply = self._process.have(self._place, self._log, {"do": "shorten"}, stopped, leaves=True)
        if reply:
            self._replace_log(self._log.then(Checkpoint(message=reply["checkpoint"])).cut())
            self._process.has_read(self._place, self._log)

    def inquire(
        self,
        update: StreamUpdate,
        doubted: FrozenSet[clingo.Symbol],
        untold: FrozenSet[clingo.Symbol],
        stopped: Optional[Stopped] = None,
    ) -> Verdict:
        """Tell whether ``update`` would have an answer, had ``untold`` never been told; raises as updates do."""
        question = question_to_message(update, doubted, untold)
        return verdict_from_message(self._process.have(self._place, self._log, question, stopped))

    def _search(self, update: Optional[StreamUpdate], stopped: Optional[Stopped]) -> SolveResult:
        results: List[SolveResult] = []
        for reply in self._process.ask(self._place, self._log, update, stopped):
            if "grounded" in reply:  # a search; a plan that was shortened later takes no entry
                self._log = self._log.then(Taken(None if results else update, reply["grounded"]))
            if reply.get("checkpoint") is not None:
                self._log = self._log.then(Checkpoint(message=reply["checkpoint"])).cut()
            results.append(result_from_message(reply))
        better = [one for one in results if one.answers and one.horizon <= results[0].horizon]
        first, result = results[0], (better or results[:1])[-1]
        result = replace(result, warnings=first.warnings, statistics=first.statistics)
        if self._process.plans:
            self._log.plan = result.plan or self._log.plan
        self._place.ahead = result.answers != results[-1].answers
        self._has_answered(result)
        self._process.has_read(self._place, self._log)
        return result
