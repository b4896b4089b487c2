"""The main program of a worker process.

:mod:`~rosoclingo.planning.workers.process` starts it. The standard input only serves as a lifeline: it closes when the
parent ends. The kernel then ends this process by SIGIO, even while it is grounding.
"""

import fcntl
import os
import pickle
import select
import signal
import time
from contextlib import suppress
from dataclasses import replace
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Tuple, Union

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.history import History
from rosoclingo.planning.question import Reply
from rosoclingo.planning.text import Message
from rosoclingo.planning.workers.logged_solver import LoggedSolver
from rosoclingo.planning.workers.protocol import CONNECTION, PROGRAM, WorkerCommand, WorkerReply

if TYPE_CHECKING:
    from rosoclingo.planning.solver import PlanSolver

NICENESS = 10
"""Niceness of an explaining process."""

GROWTH = 32 * 2**20
"""Growth in bytes since the first search after which a worker is replaced, or all that it used then if that is more."""

SEARCHES = 100
"""Least number of searches and hypothetical questions of a worker, so that one large grounding does not end it."""

REPORTING = 0.5
"""Seconds of wall time between two progress reports of a search."""


class WorkerMain:
    """Executes commands one after the other and replies to each.

    Its state consists of caches only: the history of the last command, and the groundings of the solver.
    """

    def __init__(
        self, connection: Connection, program: ReactiveProgram, growth: Optional[int] = None, **options: Any
    ) -> None:
        """Use a loaded ``program``; for the options see :class:`WorkerPool`."""
        self._connection, self._program, self._growth = connection, program, growth
        self._solver = _make_solver(program, **options)
        self._searches, self._most_memory = 0, 0  # the number of searches, and the limit in bytes
        self._start = History()  # the history before the command
        self._interrupted = False
        self._reported = time.monotonic()

    def run(self) -> None:
        """Reply that the program is loaded, then to commands; raises EOFError when the parent closes the connection."""
        self._connection.send(WorkerReply())
        while True:
            command = self._connection.recv()
            if isinstance(command, WorkerCommand):  # late interrupts are ignored
                reply = self._execute(command)
                grounds = command.name not in ("ping", "improve", "checkpoint") and command.arguments[:1] != (None,)
                has_grown = grounds and self._has_grown()  # the first memory is that of a search for an update
                self._connection.send(reply._replace(has_grown=has_grown))

    def _has_grown(self) -> bool:
        """Return whether this process uses much more memory than after its first search, and has searched often.

        Its memory grows with each grounding, because clingo never frees symbols.
        """
        memory = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE")
        if self._searches == 0:
            self._most_memory = memory + (max(GROWTH, memory) if self._growth is None else self._growth)
        self._searches += 1
        return self._searches >= SEARCHES and memory > self._most_memory

    def _execute(self, command: WorkerCommand) -> WorkerReply:
        self._reported, self._interrupted = time.monotonic(), False
        before = self._solver.log if command.continues else History()
        self._start = before.with_entries(*command.entries)
        self._solver.restore(self._start)
        try:
            call = getattr(self, command.name, None)
            call = call or partial(getattr(self._solver, command.name), stopped=self._is_interrupted)
            return self._reply(call(*command.arguments))
        except SolverError as error:
            return WorkerReply(error)

    def _reply(self, value: object, is_last: bool = True) -> WorkerReply:
        """Return the reply with ``value``; answers are sent without the atoms of old cycles."""
        if isinstance(value, SolveResult):
            value = replace(value, answers=tuple(map(self._solver.recent, value.answers)))
        elif isinstance(value, Reply):  # nobody reads the answer of a hypothetical question
            value = Reply(value.satisfiable, core=value.core)
        return WorkerReply(value, self._solver.log.entries_after(self._start) or [], is_last)

    # ---- Commands that the solver does not have ----------------------------------------------------------------------

    def ping(self) -> None:
        """Do nothing; the reply shows that the program is loaded."""

    def search(self, update: Optional[StreamUpdate], improves: bool) -> SolveResult:
        """Accept an update and search for a plan; if it ``improves``, shorten the plan until interrupted."""
        result = self._solver.search(update, self._is_interrupted)
        with suppress(SolverError):  # the first plan remains valid
            while improves and result.answers and not self._is_interrupted():
                self._connection.send(self._reply(result, is_last=False))
                better = self._solver.improve(self._is_interrupted)
                if better is None:
                    break
                result = replace(better, warnings=result.warnings, statistics=result.statistics)
        return result

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

    # ---- The parent --------------------------------------------------------------------------------------------------

    def _is_interrupted(self) -> bool:
        """Return whether to stop the running search; report its progress at intervals."""
        if time.monotonic() - self._reported >= REPORTING:
            self._reported = time.monotonic()
            self._connection.send(self._solver.reached)
        while self._connection.poll():
            self._interrupted = self._connection.recv() is None
        return self._interrupted


def _make_solver(
    program: ReactiveProgram, shortest: bool = False, plan_time: Optional[float] = None, **options: Any
) -> "Union[PlanSolver, LoggedSolver]":
    if not shortest:
        return LoggedSolver(program, **options)
    from rosoclingo.planning.solver import PlanSolver  # noqa: PLC0415 half of all modules

    return PlanSolver(program, plan_time=plan_time, **options)


def end_with_parent(lifeline: int) -> None:
    """End this process when the other end of the pipe ``lifeline`` closes."""
    signal.signal(signal.SIGIO, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGIO])
    fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(lifeline, fcntl.F_SETFL, fcntl.fcntl(lifeline, fcntl.F_GETFL) | os.O_ASYNC)
    if select.select([lifeline], [], [], 0)[0]:
        os._exit(0)  # it was closed before F_SETOWN


def work(connection: Connection, load: Callable[[], ReactiveProgram], options: Mapping[str, Any]) -> None:
    """Load the program and execute the commands that the parent sends over ``connection``."""
    end_with_parent(0)
    os.dup2(2, 1)  # scripts in a program can print, but standard output belongs to the parent
    with suppress(EOFError, ConnectionError):
        WorkerMain(connection, load(), **options).run()


def main() -> None:
    """Run a new process, see :mod:`~rosoclingo.planning.workers.process`."""
    with os.fdopen(PROGRAM, "rb") as file:
        texts, constants, options = pickle.load(file)
    work(Connection(CONNECTION), lambda: ReactiveProgram(texts, constants, whole=True), options)


if __name__ == "__main__":
    main()
