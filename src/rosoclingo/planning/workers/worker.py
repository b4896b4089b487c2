"""The parent's interface to a worker process."""

import signal
import time
from contextlib import suppress
from typing import Any, Mapping, NamedTuple, NoReturn, Optional, Tuple

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.solving.results import SolveOutcome, SolveResult
from rosoclingo.planning.history import History
from rosoclingo.planning.question import Stop
from rosoclingo.planning.workers.process import WorkerProcess
from rosoclingo.planning.workers.protocol import WorkerCommand, WorkerReply

POLL = 0.002
"""Seconds of wall time between two calls of a stop function."""


class WorkerLostError(Exception):
    """The worker process has ended; the text contains the cause."""


class WorkerRequest(NamedTuple):
    """A command of :class:`~rosoclingo.planning.workers.worker_main.WorkerMain` or of its solver.

    Attributes:
        name: the name of the command.
        arguments: the arguments of the command; the first argument of a search is the update.
        log: the history to which the command applies.

    """

    name: str
    arguments: Tuple[Any, ...] = ()
    log: History = History()

    def has_answer_of(self, other: "WorkerRequest", same_plan: bool) -> bool:
        """Return whether both are searches with the same answer, or checkpoints of the same history.

        If ``same_plan``, searches also need the same plan in force.
        """
        if self.name == other.name == "checkpoint":
            return self.log is other.log
        if not self.name == other.name == "search" or self.arguments[0] != other.arguments[0]:
            return False
        return self.log.key == other.log.key and (not same_plan or self.log.plan == other.log.plan)


_IGNORED = WorkerRequest("")
"""Stands for a command whose reply is ignored: an abandoned one, or loading the program."""


class SolverWorker(WorkerProcess):
    """A process with a program that executes one command at a time.

    Commands are sent only to an idle worker, because a worker does not read while it grounds, and sending would block.

    Attributes:
        reached: the last grounded step of the running search, as last reported.

    """

    def __init__(self, program: ReactiveProgram, options: Mapping[str, Any], patience: float, fork: bool) -> None:
        """Start a process with ``program`` and the ``options`` of its solver; raises WorkerLostError.

        The process counts as lost if it ignores a stop for ``patience`` seconds of wall time. For ``fork`` see
        :class:`WorkerProcess`.
        """
        try:
            super().__init__(program, options, fork)
        except OSError as error:
            raise WorkerLostError(f"cannot start a solver process: {error}") from None
        self._patience = patience
        self.reached = 0
        self._running: Optional[WorkerRequest] = _IGNORED  # None if the worker is idle
        self._request: Optional[WorkerRequest] = None  # the last request; it waits until the worker is idle
        self._reply: Optional[WorkerReply] = None  # the latest reply to the request
        self._interrupted = False  # whether the request is interrupted
        self._log: Optional[History] = None  # the history after the last reply; None if it is unknown
        self._last_clock, self._has_grown = 0.0, False
        self._loading_time: Optional[float] = None  # processor time used until the program was loaded

    # ---- The process -------------------------------------------------------------------------------------------------

    @property
    def is_usable(self) -> bool:
        """Whether the process is running and has not grown much."""
        return self.exit_code is None and not self._has_grown

    @property
    def cpu_time(self) -> float:
        """Seconds of processor time that the process has used since it loaded the program."""
        return 0.0 if self._loading_time is None else self._clock() - self._loading_time

    # ---- Requests ----------------------------------------------------------------------------------------------------

    def begin(self, request: WorkerRequest) -> None:
        """Begin ``request`` as soon as the worker is idle; abandon a running command."""
        self.abandon()
        self._request, self._interrupted, self.reached = request, False, 0
        self._send_request()

    def abandon(self) -> None:
        """Interrupt the running command and ignore its reply."""
        if self._running is not None:
            self._interrupt()
            self._running = _IGNORED
        self._request = self._reply = None

    def ask(self, request: WorkerRequest, stopped: Stop, idle: bool = False) -> WorkerReply:
        """Return the last reply to ``request``, with the history after it; begin the request if necessary.

        A stop interrupts the command, but not before the program is loaded. A command that improves its first answer
        is interrupted at once. An ``idle`` command is optional work: a stop abandons it, and the reply is empty; a
        checkpoint goes on until the next command, and a later call can return its reply. Raises WorkerLostError if the
        worker ignores a stop, and SolverError if it refuses the command.
        """
        if not self.has_begun(request):
            self.begin(request)
        interrupted: Optional[float] = None
        while self._running is not None:
            if self._receive(POLL):
                continue
            if interrupted is None:
                if self._reply is None and not (stopped() and (idle or self._loading_time is not None)):
                    continue
                if idle:
                    if request.name != "checkpoint":
                        self.abandon()
                    return WorkerReply()
                interrupted = time.monotonic()
                self._interrupt()
            elif time.monotonic() > interrupted + self._patience:
                raise WorkerLostError("the solver ignored a stop while grounding and was killed")
        return self._take_reply()

    def _take_reply(self) -> WorkerReply:
        request, reply, self._request, self._reply = self._request, self._reply, None, None
        assert request is not None
        assert reply is not None
        if isinstance(reply.value, SolverError):
            raise reply.value
        self._log = request.log.with_entries(*reply.entries)
        return reply._replace(log=self._log)

    def is_busy(self) -> bool:
        """Return whether the process loads the program or executes a command."""
        with suppress(WorkerLostError):
            while self._receive(0.0):
                pass
        return self.exit_code is None and self._running is not None

    def has_begun(self, request: WorkerRequest, same_plan: bool = False) -> bool:
        """Return whether the process has begun ``request``, or a request with the same answer."""
        begun = self._request
        return self.exit_code is None and begun is not None and begun.has_answer_of(request, same_plan)

    def has_answer(self, request: WorkerRequest, stopped: Stop) -> bool:
        """Return whether the process has found the answer to ``request``; wait for it until ``stopped``."""
        while self.has_begun(request) and self.is_busy() and self._reply is None and not stopped():
            with suppress(WorkerLostError):
                self._receive(POLL)
        result = None if self._reply is None or not self.has_begun(request) else self._reply.value
        return isinstance(result, SolveResult) and result.outcome is not SolveOutcome.INTERRUPTED

    # ---- Messages ----------------------------------------------------------------------------------------------------

    def _send_request(self) -> None:
        """Send the request if the worker is idle.

        The worker gets the entries that follow its own history if it can, otherwise the whole history.
        """
        if self._running is not None or self._request is None:
            return
        name, arguments, log = self._running = self._request
        later = None if self._log is None else log.entries_after(self._log)
        entries, self._log = log.entries if later is None else later, None
        with suppress(OSError):  # it has ended, as the next call of _receive finds
            self.connection.send(WorkerCommand(name, arguments, entries, later is not None))
        if self._interrupted:
            self._interrupt()

    def _interrupt(self) -> None:
        """Interrupt the running command."""
        self._interrupted = True
        with suppress(OSError):  # as above
            self.connection.send(None)

    def _receive(self, timeout: float) -> bool:
        """Wait at most ``timeout`` seconds for a message and process it; return whether there was one."""
        try:
            if not self.connection.poll(timeout):
                return False
            message = self.connection.recv()
        except (EOFError, OSError):
            self._raise_lost()
        if isinstance(message, WorkerReply):
            if self._running is self._request:
                self._reply = message
            if self._loading_time is None:
                self._loading_time = self._clock()
            if message.is_last:
                self._running, self._has_grown = None, message.has_grown
                if self._reply is None:
                    self._send_request()
        else:
            self.reached = message
        return True

    def _clock(self) -> float:
        """Return the seconds of processor time that the process has used."""
        with suppress(OSError):
            self._last_clock = time.clock_gettime((~self.pid << 3) | 2)  # see clock_getcpuclockid(3)
        return self._last_clock

    def _raise_lost(self) -> NoReturn:
        code = self.kill()
        how = f"with exit code {code}" if code >= 0 else f"by signal {signal.Signals(-code).name}"
        raise WorkerLostError(f"the solver process ended {how}")
