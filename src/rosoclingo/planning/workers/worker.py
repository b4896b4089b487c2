"""The parent's interface to a worker process."""

import os
import signal
import socket
import time
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple, NoReturn, Optional, Tuple

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.solving.results import SolveOutcome, SolveResult
from rosoclingo.planning.history import History
from rosoclingo.planning.question import Stop, never
from rosoclingo.planning.workers.channel import Channel
from rosoclingo.planning.workers.process import WorkerProcess
from rosoclingo.planning.workers.protocol import Interrupt, SearchProgress, WorkerCommand, WorkerReply

POLL = 0.002
"""Seconds of wall time between two calls of a stop function."""

GROWTH = 32 * 2**20
"""Growth in bytes after which a worker is replaced; at least half of its first size."""

GRACE = 1.0
"""Seconds of wall time after a stop until a worker drops a grounding between two pieces."""


_DECIDED = SolveOutcome.SATISFIABLE, SolveOutcome.UNSATISFIABLE


class WorkerLostError(Exception):
    """The worker process has ended; the text contains the cause."""


class WorkerRequest(NamedTuple):
    """A command of :class:`~rosoclingo.planning.workers.worker_main.WorkerMain`.

    Attributes:
        name: the name of the command.
        arguments: the arguments of the command; the first argument of a search is the update.
        log: the history to which the command applies, None if it needs no history.

    """

    name: str
    arguments: Tuple[Any, ...] = ()
    log: Optional[History] = None

    def has_answer_of(self, other: "WorkerRequest") -> bool:
        """Return whether both are searches with the same answer."""
        if self.log is None or other.log is None or self.name != "search" or other.name != "search":
            return False
        return self.arguments[0] == other.arguments[0] and (self.log is other.log or self.log.key == other.log.key)


class SolverWorker:
    """A process with a program that executes one command at a time.

    Attributes:
        is_ready: whether the process has loaded the program.
        reached: the last grounded step of the running search, as last reported.
        request: the last request; None after :meth:`abandon` or after its reply was returned.
        log: the history after the last reply; None while a command is running and after a failure.

    """

    def __init__(self, load: WorkerRequest, patience: float, program: Optional[ReactiveProgram] = None) -> None:
        """Start a process and send it the request to ``load`` the program; raises WorkerLostError.

        The process counts as lost if it ignores a stop for ``patience`` seconds of wall time. If a ``program`` is
        given, the process is a fork of this one, see :class:`WorkerProcess`; the call returns when the fork is ready.
        """
        self._patience = patience
        ours, theirs = socket.socketpair()
        with theirs:
            try:
                self._process = WorkerProcess(theirs, program)
            except OSError as error:
                ours.close()
                raise WorkerLostError(f"cannot start a solver process: {error}") from None
        self._channel = Channel(ours)
        self._open = 0  # number of commands that have not sent their last reply
        self._reply: Optional[WorkerReply] = None  # the reply to the last command
        self._last_clock, self._loading_time, self._first_memory = 0.0, 0.0, 0
        self.is_ready, self.reached = False, 0
        self.request: Optional[WorkerRequest] = None
        self.log: Optional[History] = None
        self.begin(load)
        if program is not None:
            self.wait_until_ready(never)

    # ---- The process -------------------------------------------------------------------------------------------------

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether the process is running."""
        return self._process.exit_code is None

    @property
    def memory(self) -> int:
        """Bytes of main memory that the process uses; 0 if it has ended."""
        with suppress(OSError):
            pages = int(Path(f"/proc/{self.pid}/statm").read_text(encoding="ascii").split()[1])
            return pages * os.sysconf("SC_PAGE_SIZE")
        return 0

    @property
    def cpu_time(self) -> float:
        """Seconds of processor time that the process has used since it loaded the program."""
        return self._clock() - self._loading_time if self.is_ready else 0.0

    def has_grown(self) -> bool:
        """Return whether the process uses much more memory than at the first call; clingo never frees symbols."""
        self.is_busy()  # reads the reply to the first command
        memory = self.memory if self.is_ready else 0
        self._first_memory = self._first_memory or memory
        return memory > self._first_memory + max(GROWTH, self._first_memory // 2)

    def kill(self) -> None:
        """Kill the process and close the connection."""
        self._process.kill()
        self._channel.close()

    # ---- Requests ----------------------------------------------------------------------------------------------------

    def begin(self, request: WorkerRequest) -> None:
        """Send the command of ``request``; abandon a running command.

        The worker gets the entries that follow its own history if it can, otherwise the whole history.
        """
        self.abandon()
        name, arguments, log = request
        entries = None if log is None or self.log is None else log.entries_after(self.log)
        continues = entries is not None
        if log is not None and entries is None:
            entries = log.entries
        self._channel.send(WorkerCommand(name, arguments, entries, continues))
        self.request, self.log, self.reached = request, None, 0
        self._open += 1

    def abandon(self) -> None:
        """Interrupt the running command and ignore its reply."""
        if self._open:
            self._interrupt(0.0)
        self.request = self._reply = None

    def wait_until_ready(self, stopped: Stop) -> None:
        """Wait until the program is loaded, or until ``stopped``."""
        while not self.is_ready and not stopped():
            self._receive(POLL)

    def ask(self, request: WorkerRequest, stopped: Stop, idle: bool = False) -> WorkerReply:
        """Return the last reply to ``request``, with the history after it; begin the request if necessary.

        A stop interrupts the command, but not before the program is loaded. A command that improves its first answer
        is interrupted at once. An ``idle`` command is optional work: a stop abandons it, and the reply is empty. Raises
        WorkerLostError if the worker ignores a stop, and SolverError if it refuses the command.
        """
        if not self.has_begun(request):
            self.begin(request)
        reply = self._wait(stopped, idle)
        begun, self.request, self._reply = self.request, None, None
        if isinstance(reply.value, SolverError):
            raise reply.value
        if begun is not None and begun.log is not None:
            self.log = begun.log.with_entries(*reply.entries).cut()
        return reply._replace(log=self.log)

    def _wait(self, stopped: Stop, idle: bool) -> WorkerReply:
        """Wait for the last reply to the running command."""
        interrupted: Optional[float] = None
        while self._open:
            if self._receive(POLL):
                continue
            if interrupted is None:
                if self._reply is None and not (stopped() and (idle or self.is_ready)):
                    continue
                if idle:
                    self.abandon()
                    break
                interrupted = time.monotonic()
                self._interrupt(GRACE)
            elif time.monotonic() > interrupted + self._patience:
                raise WorkerLostError("the solver ignored a stop while grounding and was killed")
        return self._reply or WorkerReply()

    def is_busy(self) -> bool:
        """Return whether the process loads the program or executes a command."""
        with suppress(WorkerLostError):
            while self._receive(0.0):
                pass
        return self.alive and self._open > 0

    def has_begun(self, request: WorkerRequest, same_plan: bool = False) -> bool:
        """Return whether the process has begun ``request``, or a request with the same answer.

        Unless ``same_plan``, the plans in force can differ.
        """
        begun = self.request
        if not self.alive or begun is None or not begun.has_answer_of(request):
            return False
        return not same_plan or (begun.log and begun.log.plan) == (request.log and request.log.plan)

    def has_answer(self, request: WorkerRequest, stopped: Stop) -> bool:
        """Return whether the process has found the answer to ``request``; wait for it until ``stopped``."""
        while self.has_begun(request) and self.is_busy() and self._reply is None and not stopped():
            with suppress(WorkerLostError):
                self._receive(POLL)
        result = None if self._reply is None else self._reply.value
        return self.has_begun(request) and isinstance(result, SolveResult) and result.outcome in _DECIDED

    def _interrupt(self, grace: float) -> None:
        """Interrupt the running command; the worker drops a grounding after ``grace`` seconds."""
        self._channel.send(Interrupt(time.monotonic() + grace))

    def _receive(self, timeout: float) -> bool:
        """Wait at most ``timeout`` seconds for a message and process it; return whether there was one."""
        try:
            if not self._channel.wait(timeout):
                return False
        except EOFError:
            self._raise_lost()
        message = self._channel.unread.popleft()
        if isinstance(message, SearchProgress):
            self.reached = message.horizon
            return True
        if self._open == 1:
            self._reply = message
        self._open -= message.is_last
        if not self.is_ready:
            self._loading_time, self.is_ready = self._clock(), True
        return True

    def _clock(self) -> float:
        """Return the seconds of processor time that the process has used."""
        with suppress(OSError):
            self._last_clock = time.clock_gettime((~self.pid << 3) | 2)  # see clock_getcpuclockid(3)
        return self._last_clock

    def _raise_lost(self) -> NoReturn:
        self.kill()
        code = self._process.kill()
        how = f"with exit code {code}" if code >= 0 else f"by signal {signal.Signals(-code).name}"
        raise WorkerLostError(f"the solver process ended {how}")
