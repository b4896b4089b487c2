"""The main program of a worker process.

:mod:`~rosoclingo.planning.workers.process` starts it. The standard input only serves as a lifeline: it closes when the
parent ends. The kernel then ends this process by SIGIO, even while it is grounding.
"""

import fcntl
import os
import select
import signal
import socket
import time
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Dict, FrozenSet, Iterator, Optional, Sequence, Tuple, Union

import clingo

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.history import History
from rosoclingo.planning.question import Reply
from rosoclingo.planning.text import Message
from rosoclingo.planning.workers.channel import CONNECTION, Channel
from rosoclingo.planning.workers.logged_solver import LoggedSolver
from rosoclingo.planning.workers.protocol import Interrupt, SearchProgress, WorkerCommand, WorkerReply

if TYPE_CHECKING:
    from rosoclingo.planning.solver import PlanSolver

NICENESS = 10
"""Niceness of an explaining process."""

REPORTING = 0.5
"""Seconds of wall time between two progress reports of a search."""


class WorkerMain:
    """Executes commands one after the other and replies to each; its public methods are the commands.

    Its state consists of caches only: the history of the last command, and the groundings of the solver.
    """

    def __init__(self, channel: Channel, program: Optional[ReactiveProgram] = None) -> None:
        """Use ``program``; if it is None, :meth:`load` loads one."""
        self._channel, self._given = channel, program
        self._reported = time.monotonic()
        self._solver: Union[PlanSolver, LoggedSolver]
        self._start = History()  # the history before the command

    def run(self) -> None:
        """Execute commands; raises EOFError when the parent closes the connection."""
        while True:
            self._channel.wait()
            command = self._channel.unread.popleft()
            if isinstance(command, WorkerCommand):  # late interrupts are ignored
                self._channel.send(self._execute(command))

    def _execute(self, command: WorkerCommand) -> WorkerReply:
        self._reported = time.monotonic()
        if command.entries is not None:
            before = self._solver.log if command.continues else History()
            self._start = before.with_entries(*command.entries)
            self._solver.restore(self._start)
        try:
            return self._reply(getattr(self, command.name)(*command.arguments))
        except SolverError as error:
            return WorkerReply(error)

    def _reply(self, value: object, is_last: bool = True) -> WorkerReply:
        """Return the reply with ``value``; answers are sent without the atoms of old cycles."""
        if isinstance(value, SolveResult):
            value = replace(value, answers=tuple(map(self._solver.recent, value.answers)))
        return WorkerReply(value, self._solver.log.entries_after(self._start) or [], is_last)

    # ---- Commands ----------------------------------------------------------------------------------------------------

    def load(self, sources: Sequence[Source], constants: Dict[str, str], options: Dict[str, Any]) -> None:
        """Load a program from the texts of its files; for ``options`` see :class:`WorkerPool`."""
        self._program = self._given or ReactiveProgram(sources, constants, whole=True)
        if options.pop("shortest", False):
            from rosoclingo.planning.solver import PlanSolver  # noqa: PLC0415 half of all modules

            self._solver = PlanSolver(self._program, dropped=self._is_dropped, **options)
        else:
            options.pop("plan_time", None)
            self._solver = LoggedSolver(self._program, self._is_dropped, **options)

    def search(self, update: Optional[StreamUpdate], improves: bool) -> SolveResult:
        """Accept an update and search for a plan; if it ``improves``, shorten the plan until interrupted."""
        result = self._solver.search(update, self._is_interrupted)
        with suppress(SolverError):  # the first plan remains valid
            while improves and result.answers and not self._is_interrupted():
                self._channel.send(self._reply(result, is_last=False))
                better = self.improve()
                if better is None:
                    break
                result = replace(better, warnings=result.warnings, statistics=result.statistics)
        return result

    def improve(self) -> Optional[SolveResult]:
        """Search for a better plan."""
        return self._planner.improve(self._is_interrupted)

    def checkpoint(self) -> None:
        """Append a checkpoint to the history."""
        self._planner.checkpoint()

    def inquire(
        self, update: StreamUpdate, assumable: FrozenSet[clingo.Symbol], disabled: FrozenSet[clingo.Symbol]
    ) -> Reply:
        """Decide whether ``update`` has an answer if the ``disabled`` facts do not hold."""
        reply = self._planner.inquire(update, assumable, disabled, self._is_interrupted)
        return Reply(reply.satisfiable, core=reply.core)

    def explain(self, update: StreamUpdate, steps: int) -> Optional[Tuple[str, Message]]:
        """Explain, in words and as a value for JSON, why there is no plan; return None if there is one."""
        from rosoclingo.planning.explaining.explainer import explain  # noqa: PLC0415 rarely needed
        from rosoclingo.planning.explaining.questions import Stream  # noqa: PLC0415
        from rosoclingo.planning.minimal_sets import UndecidedError  # noqa: PLC0415

        os.nice(NICENESS)
        try:
            found = explain(self._program, Stream(self._start, update, steps), self._is_interrupted)
        except UndecidedError:
            raise DroppedError("stopped before a cause was found") from None
        return None if found is None else (found.text(), found.to_message())

    @property
    def _planner(self) -> "PlanSolver":
        assert not isinstance(self._solver, LoggedSolver)
        return self._solver

    # ---- The parent --------------------------------------------------------------------------------------------------

    def _is_interrupted(self) -> bool:
        """Return whether to stop the running search; report its progress at intervals."""
        if time.monotonic() - self._reported >= REPORTING:
            self._reported = time.monotonic()
            self._channel.send(SearchProgress(self._solver.reached))
        return any(self._interrupts())

    def _is_dropped(self) -> bool:
        """Return whether to drop the running command."""
        return any(time.monotonic() >= one.drop_at for one in self._interrupts())

    def _interrupts(self) -> Iterator[Interrupt]:
        """Yield the messages that interrupt the running command."""
        self._channel.wait(0.0)
        return (one for one in self._channel.unread if isinstance(one, Interrupt))


def end_with_parent(lifeline: int) -> None:
    """End this process when the other end of the pipe ``lifeline`` closes."""
    signal.signal(signal.SIGIO, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGIO])
    fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(lifeline, fcntl.F_SETFL, fcntl.fcntl(lifeline, fcntl.F_GETFL) | os.O_ASYNC)
    if select.select([lifeline], [], [], 0)[0]:
        raise SystemExit(0)  # it was closed before F_SETOWN


def work(connection: socket.socket, program: Optional[ReactiveProgram] = None) -> None:
    """Execute the commands that the parent sends over ``connection``."""
    end_with_parent(0)
    os.dup2(2, 1)  # scripts in a program can print, but standard output belongs to the parent
    with suppress(EOFError):
        WorkerMain(Channel(connection), program).run()


if __name__ == "__main__":
    work(socket.socket(fileno=CONNECTION))
