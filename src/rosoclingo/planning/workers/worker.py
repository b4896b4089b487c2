"""A worker process, as the parent process sees it."""

import os
import signal
import socket
import time
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple, NoReturn, Optional, Tuple

from rosoclingo.oclingo.errors import DroppedError, NotReadyError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.planning.history import History, entry_from_message, entry_to_line
from rosoclingo.planning.question import Stop
from rosoclingo.planning.text import Message
from rosoclingo.planning.workers.channel import Channel
from rosoclingo.planning.workers.process import WorkerProcess

POLL = 0.002
"""Seconds of wall time between two calls of a stop function."""

GROWTH = 32 * 2**20
"""A worker is replaced when it has grown by this number of bytes, or by half of its first size if that is more."""

Patience = Tuple[float, float]
"""Seconds of wall time after a stop until a command is dropped, and until the worker is killed."""


class WorkerLostError(Exception):
    """The worker process has ended; the text says how."""


class Search(NamedTuple):
    """A search for an answer to ``update`` after ``log``; if it ``improves``, it then shortens the plan."""

    log: History
    update: Optional[StreamUpdate]
    improves: bool = False

    @property
    def command(self) -> Message:
        """The command for a worker."""
        text = None if self.update is None else str(self.update)
        return {"do": "update", "update": text, "improves": self.improves}

    def has_answer_of(self, other: "Search") -> bool:
        """Return whether both have the same answer."""
        return self.update == other.update and (self.log is other.log or self.log.key == other.log.key)


class Worker:
    """A process with a program that executes one command at a time.

    Attributes:
        is_ready: whether it has loaded the program.
        reached: the last grounded step of the running search, as last reported.
        search: the search that was begun last; None after :meth:`abandon` and for other commands.
        log: the history after the last reply; None while a command is running, or after a failure.

    """

    def __init__(self, load: Message, patience: Patience, program: Optional[ReactiveProgram] = None) -> None:
        """Start a process and send it the command ``load``; raises WorkerLostError.

        With a ``program`` the process is a fork of this one, see :class:`WorkerProcess`, and is waited for, as it is
        ready at once. Otherwise ``load`` brings the program.
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
        self._open = 0  # number of commands whose last reply is missing
        self._reply: Optional[Message] = None  # to the last command
        self._cpu_time, self._first_memory = 0.0, 0
        self.is_ready, self.reached = False, 0
        self.search: Optional[Search] = None
        self.log: Optional[History] = None
        self._start: Optional[History] = None  # the history before the last command
        self.begin(load)
        if program is not None:
            self.wait_until_ready(None)

    # ---- The process -------------------------------------------------------------------------------------------------

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether the process still runs."""
        return self._process.exit_code is None

    @property
    def memory(self) -> int:
        """Bytes of main memory that the process holds; 0 if it has ended."""
        with suppress(OSError):
            pages = int(Path(f"/proc/{self.pid}/statm").read_text(encoding="ascii").split()[1])
            return pages * os.sysconf("SC_PAGE_SIZE")
        return 0

    @property
    def cpu_time(self) -> float:
        """Seconds of processor time that the process has used."""
        with suppress(OSError):
            self._cpu_time = time.clock_gettime((~self.pid << 3) | 2)  # see clock_getcpuclockid(3)
        return self._cpu_time

    def has_grown(self) -> bool:
        """Return whether it uses much more memory than at the first call: clingo never frees symbols."""
        self.is_busy()  # reads the reply to the first command
        memory = self.memory if self.is_ready else 0
        self._first_memory = self._first_memory or memory
        return memory > self._first_memory + max(GROWTH, self._first_memory // 2)

    def kill(self) -> None:
        """Kill the process and close the connection."""
        self._process.kill()
        self._channel.close()

    # ---- Commands ----------------------------------------------------------------------------------------------------

    def begin(self, command: Message, log: Optional[History] = None, search: Optional[Search] = None) -> None:
        """Send ``command``, for a history or none, which can be that of a ``search``; abandon a running command.

        The worker gets the entries that follow its own history if it can, otherwise the whole history.
        """
        self.abandon()
        if log is not None:
            entries = None if self.log is None else log.entries_after(self.log)
            text = log.text() if entries is None else "".join(map(entry_to_line, entries))
            command = {**command, "history": text, "continues": entries is not None}
        self.log, self._start = None, log
        self._channel.send(command)
        self._open += 1
        self.search, self.reached = search, 0

    def abandon(self) -> None:
        """Interrupt the running command and ignore its reply."""
        if self._open:
            self._interrupt(0.0)
        self.search = self._reply = None

    def wait_until_ready(self, stopped: Optional[Stop]) -> None:
        """Wait until the program is loaded; raises NotReadyError after a stop."""
        while not self.is_ready:
            if not self._receive(POLL) and stopped is not None and stopped():
                raise NotReadyError("stopped before the solver was ready: nothing was solved; resend the update")

    def ask(self, command: Message, log: Optional[History], stopped: Optional[Stop], idle: bool = False) -> Message:
        """Execute ``command`` once the program is loaded; see :meth:`begin` and :meth:`finish`."""
        self.wait_until_ready(stopped)
        self.begin(command, log)
        return self.finish(stopped, idle)

    def finish(self, stopped: Optional[Stop], idle: bool = False) -> Message:
        """Wait for the last reply to the running command; return it with the histories before and after it.

        A stop interrupts the command, and so does a first answer that is being improved. If the worker does not react,
        the command is dropped and then WorkerLostError raised, see :data:`Patience`. An ``idle`` command, which is
        optional work, is abandoned at a stop with an empty reply. Raises SolverError if the worker refuses the command.
        """
        interrupted: Optional[float] = None
        while self._open:
            if self._receive(POLL):
                continue
            if interrupted is None:
                if self._reply is None and (stopped is None or not stopped()):
                    continue
                if idle:
                    self.abandon()
                    return {}
                interrupted = time.monotonic()
                self._interrupt(self._patience[0])
            elif time.monotonic() > interrupted + self._patience[1]:
                raise WorkerLostError("the solver ignored a stop while grounding and was killed")
        reply, self.search, self._reply = self._reply or {}, None, None
        if "refused" in reply:
            raise (DroppedError if reply["dropped"] else SolverError)(reply["refused"])
        if self._start is not None:
            self.log = self._start.with_entries(*map(entry_from_message, reply.get("entries", ()))).cut()
            reply = {**reply, "start": self._start, "log": self.log}
        return reply

    def is_busy(self) -> bool:
        """Return whether it loads the program or executes a command."""
        with suppress(WorkerLostError):
            while self._receive(0.0):
                pass
        return self.alive and self._open > 0

    def searches(self, search: Search) -> bool:
        """Return whether it has begun ``search``, or one with the same answer."""
        return self.alive and self.search is not None and self.search.has_answer_of(search)

    def has_answer(self, search: Search, stopped: Optional[Stop] = None) -> bool:
        """Return whether it has found the answer to ``search``; wait for it until ``stopped``."""
        while self.searches(search) and self.is_busy() and self._reply is None and stopped is not None:
            if stopped():
                break
            with suppress(WorkerLostError):
                self._receive(POLL)
        result = (self._reply or {}).get("result", {})
        return self.searches(search) and result.get("outcome") in ("satisfiable", "unsatisfiable")

    def _interrupt(self, grace: float) -> None:
        """Interrupt the running command; a grounding is dropped after ``grace`` seconds."""
        self._channel.send({"do": "interrupt", "drop_at": time.monotonic() + grace})  # processes share this clock

    def _receive(self, timeout: float) -> bool:
        """Process one message, waiting at most ``timeout`` seconds for it; return whether there was one."""
        try:
            if not self._channel.wait(timeout):
                return False
        except EOFError:
            self._raise_lost()
        message = self._channel.unread.popleft()
        if "reached" in message:
            self.reached = message["reached"]
            return True
        if self._open == 1:
            self._reply = message
        self._open -= "more" not in message
        self.is_ready = True
        return True

    def _raise_lost(self) -> NoReturn:
        self.kill()
        code = self._process.kill()
        how = f"with exit code {code}" if code >= 0 else f"by signal {signal.Signals(-code).name}"
        raise WorkerLostError(f"the solver process ended {how}")
