"""A worker as seen from its parent: a process with a program that does commands, one after the other."""

import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple, NoReturn, Optional, Tuple

from rosoclingo.oclingo.errors import DroppedError, Fault, NotReadyError, ProgramError, SolverError
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.planning.history import History, entry_from_message, entry_to_line
from rosoclingo.planning.question import Stop
from rosoclingo.planning.text import Message
from rosoclingo.planning.workers.channel import Channel

POLL = 0.002
"""Seconds of wall time between two calls of a stop request."""

GROWTH = 32 * 2**20
"""Bytes by which a worker may grow before it is replaced; half of its first size if that is more."""

Patience = Tuple[float, float]
"""Seconds of wall time after a stop until a command is dropped, and until the worker is killed."""


class WorkerLostError(Exception):
    """The worker has ended; the text says how."""


class Search(NamedTuple):
    """A search for an answer to ``update`` after ``log``; if it ``improves`` it shortens the plan until interrupted."""

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
    """A process with a program, which does the last command that was begun.

    It has a session of its own, so that a Ctrl-C in the terminal does not reach it, and ends with its parent.

    Attributes:
        is_ready: whether it has loaded the program.
        reached: the last step that the search under way has ground, as far as the worker has reported.
        search: the search that was begun last; None after :meth:`abandon` and for other commands.
        log: the history to which the last reply has led; None while a command is under way, or if it has failed.

    """

    def __init__(self, load: Message) -> None:
        """Start a process that does the command ``load``; raises WorkerLostError if it can't be started."""
        ours, theirs = socket.socketpair()
        search_path = os.pathsep.join(filter(None, sys.path))
        with theirs:
            try:
                self._process = subprocess.Popen(
                    [sys.executable, "-m", "rosoclingo.planning.workers.worker_main", str(theirs.fileno())],
                    stdin=subprocess.PIPE,  # closed when this process ends
                    pass_fds=[theirs.fileno()],
                    start_new_session=True,
                    env=dict(os.environ, PYTHONPATH=search_path),
                )
            except OSError as error:
                ours.close()
                raise WorkerLostError(f"no solver process can be started: {error}") from None
        self._channel = Channel(ours)
        self._open = 0  # commands without their last reply
        self._reply: Optional[Message] = None  # to the command that was begun last
        self._worked, self._first_memory = 0.0, 0
        self.is_ready, self.reached = False, 0
        self.search: Optional[Search] = None
        self.log: Optional[History] = None
        self._start: Optional[History] = None  # the history of the command that was begun last
        self.begin(load)

    # ---- The process -------------------------------------------------------------------------------------------------

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether the process still runs."""
        return self._process.poll() is None

    @property
    def memory(self) -> int:
        """Bytes of main memory that the process holds; 0 if it has ended."""
        with suppress(OSError):
            pages = int(Path(f"/proc/{self.pid}/statm").read_text(encoding="ascii").split()[1])
            return pages * os.sysconf("SC_PAGE_SIZE")
        return 0

    @property
    def worked(self) -> float:
        """Seconds of processor time that the process has used."""
        with suppress(OSError):
            self._worked = time.clock_gettime((~self.pid << 3) | 2)  # as clock_getcpuclockid(3) has it
        return self._worked

    def has_grown(self) -> bool:
        """Return whether it holds much more memory than at the first call: clingo never frees a term."""
        self.is_busy()  # takes the reply to the first command
        memory = self.memory if self.is_ready else 0
        self._first_memory = self._first_memory or memory
        return memory > self._first_memory + max(GROWTH, self._first_memory // 2)

    def kill(self) -> None:
        """Kill the process, whatever it does, and release all that belongs to it."""
        self._process.kill()
        self._process.wait()
        self._channel.close()
        if self._process.stdin is not None:
            self._process.stdin.close()

    # ---- Commands ----------------------------------------------------------------------------------------------------

    def begin(self, command: Message, log: Optional[History] = None, search: Optional[Search] = None) -> None:
        """Have the worker do ``command`` after ``log``, that of a ``search`` or another one; abandon the one before.

        The worker gets the entries that have followed its own history, or else the whole history.
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
        """Interrupt the command under way; nobody waits for its reply."""
        if self._open:
            self._interrupt(0.0)
        self.search = self._reply = None

    def wait_until_ready(self, stopped: Optional[Stop]) -> None:
        """Wait until the program is loaded; raises NotReadyError if ``stopped`` came first, and ProgramError."""
        while not self.is_ready:
            if not self._receive(POLL) and stopped is not None and stopped():
                raise NotReadyError("stopped before the solver was ready: nothing was solved, send it again")

    def ask(
        self,
        command: Message,
        log: Optional[History],
        stopped: Optional[Stop],
        patience: Patience,
        idly: bool = False,
    ) -> Message:
        """Do ``command`` once the program is loaded; see :meth:`wait_until_ready`, :meth:`begin`, :meth:`finish`."""
        self.wait_until_ready(stopped)
        self.begin(command, log)
        return self.finish(stopped, patience, idly)

    def finish(self, stopped: Optional[Stop], patience: Patience, idly: bool = False) -> Message:
        """Wait for the last reply to the command under way, and return it with the histories before and after it.

        A stop interrupts the command; so does an answer that is only improved. After the first seconds of ``patience``
        it is dropped, after the second ones WorkerLostError is raised. A command that is done ``idly``, to improve what
        there is, is abandoned at a stop, with an empty reply. Raises SolverError if the worker refuses the command.
        """
        interrupted: Optional[float] = None
        while self._open:
            if self._receive(POLL):
                continue
            if interrupted is None:
                if self._reply is None and (stopped is None or not stopped()):
                    continue
                if idly:
                    self.abandon()
                    return {}
                interrupted = time.monotonic()
                self._interrupt(patience[0])
            elif time.monotonic() > interrupted + patience[1]:
                raise WorkerLostError("the solver did not heed a stop, since it was grounding, and was ended")
        reply, self.search, self._reply = self._reply or {}, None, None
        if "refused" in reply:
            raise (DroppedError if reply["dropped"] else SolverError)(reply["refused"])
        if self._start is not None:
            self.log = self._start.with_entries(*map(entry_from_message, reply.get("entries", ()))).cut()
        return {**reply, "start": self._start, "log": self.log}

    def is_busy(self) -> bool:
        """Return whether it loads the program, or a command is under way."""
        with suppress(WorkerLostError):
            while self._receive(0.0):
                pass
        return self.alive and self._open > 0

    def searches(self, search: Search) -> bool:
        """Return whether it searches the answer to ``search``, or has it."""
        return self.alive and self.search is not None and self.search.has_answer_of(search)

    def has_answer(self, search: Search) -> bool:
        """Return whether it has found the answer to ``search``."""
        self.is_busy()
        result = (self._reply or {}).get("result", {})
        return self.searches(search) and result.get("outcome") in ("satisfiable", "unsatisfiable")

    def _interrupt(self, grace: float) -> None:
        """Interrupt the command under way, and have a grounding dropped in so many seconds."""
        self._channel.send({"do": "interrupt", "drop_at": time.monotonic() + grace})  # the clock of all processes

    def _receive(self, timeout: float) -> bool:
        """Take a message, waiting for it at most ``timeout`` seconds; return whether there was one."""
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
        if "faults" in message:
            raise ProgramError([Fault(**one) for one in message["faults"]])
        return True

    def _raise_lost(self) -> NoReturn:
        self.kill()
        code = self._process.returncode
        how = f"with exit code {code}" if code >= 0 else f"by signal {signal.Signals(-code).name}"
        raise WorkerLostError(f"the solver process ended {how}")
