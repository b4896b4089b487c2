"""A worker process as seen from its parent: started, asked, ended."""

import fcntl
import os
import selectors
import signal
import subprocess
import sys
import time
from collections import deque
from contextlib import suppress
from pathlib import Path
from typing import IO, Callable, Deque, NoReturn, Optional, Tuple

from rosoclingo.planning.workers.wire import Lines, Message, encode

POLL = 0.002
"""Seconds of wall time between two looks at the stop request."""

GROWTH = 32 * 2**20
"""Bytes by which a child may grow before it is replaced; by half of what it began with, where that is more."""

REACHED = "reached"
"""The member of what is no reply, but tells in the midst of a search up to which step it has ground."""

_CHUNK = 1 << 20

_SET_PIPE_SIZE = 1031
"""As in Linux's fcntl.h; Python has a name for it from 3.10 on."""

Stopped = Callable[[], bool]


class WorkerLostError(Exception):
    """The worker process has ended; the text says how."""


class Growth:
    """How much a child has grown since it was looked at first: clingo never forgets a term."""

    def __init__(self) -> None:
        self._first: Optional[int] = None

    def is_too_much(self, memory: int) -> bool:
        """Tell whether it is to be replaced, with so many bytes of memory."""
        if self._first is None:
            self._first = memory
        return memory > self._first + max(GROWTH, self._first // 2)


class Pipes:
    """The pipes to and from a child, none of which is waited for: a child that is grounding does not read.

    What does not fit in is written, and what comes is read, whenever somebody asks for messages.
    """

    def __init__(self, commands: IO[bytes], replies: IO[bytes]) -> None:
        self._commands, self._replies = commands, replies
        self._unsent = bytearray()
        self._lines = Lines()
        self._messages: Deque[Message] = deque()
        self._over = False  # nothing more comes
        self._selector = selectors.DefaultSelector()
        self._selector.register(replies, selectors.EVENT_READ)
        for pipe in (commands, replies):
            os.set_blocking(pipe.fileno(), False)
            with suppress(OSError):  # the system may allow less
                fcntl.fcntl(pipe.fileno(), _SET_PIPE_SIZE, _CHUNK)

    def write(self, data: bytes) -> None:
        """Write ``data`` behind what is unwritten; raises BrokenPipeError where nobody reads."""
        self._unsent += data
        self._flush()

    def next(self, timeout: float) -> Optional[Message]:
        """Wait up to ``timeout`` seconds for a message, None for none; raises EOFError where there will be no more."""
        limit = time.monotonic() + timeout
        while True:
            with suppress(BrokenPipeError):  # what was told before is read
                self._flush()
            self._drain()
            if self._messages:
                return self._messages.popleft()
            if self._over:
                raise EOFError
            left = limit - time.monotonic()
            if left <= 0.0:
                return None
            self._wait(left)

    def close(self) -> None:
        """Write and read nothing any more."""
        self._selector.close()
        for pipe in (self._commands, self._replies):
            pipe.close()

    def _wait(self, timeout: float) -> None:
        """Wait until something can be read, or what is unwritten can be written."""
        if self._unsent:
            self._selector.register(self._commands, selectors.EVENT_WRITE)
        self._selector.select(timeout)
        if self._unsent:
            self._selector.unregister(self._commands)

    def _flush(self) -> None:
        with suppress(BlockingIOError):
            while self._unsent:
                del self._unsent[: os.write(self._commands.fileno(), self._unsent[:_CHUNK])]

    def _drain(self) -> None:
        with suppress(BlockingIOError):
            while not self._over:
                data = os.read(self._replies.fileno(), _CHUNK)
                self._over = not data
                self._messages.extend(self._lines.feed(data))


class WorkerProcess:
    """One child process that runs :mod:`rosoclingo.planning.workers.worker_main`.

    It has a session of its own, so that a Ctrl-C in the terminal does not reach it, and ends with its parent.

    Attributes:
        reached: the last step that was ground in the midst of a search, as far as it has told.

    """

    def __init__(self) -> None:
        """Start the child; raises OSError where that can't be done."""
        reading, writing = os.pipe()
        self._lifeline: IO[bytes] = os.fdopen(writing, "wb", buffering=0)
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "rosoclingo.planning.workers.worker_main", str(reading)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                bufsize=0,
                pass_fds=[reading],
                start_new_session=True,
                env=dict(os.environ, PYTHONPATH=os.pathsep.join(filter(None, sys.path))),
            )
        finally:
            os.close(reading)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._pipes = Pipes(self._process.stdin, self._process.stdout)
        self.reached = 0
        self._unwanted = 0  # so many of the replies to come
        self._worked = 0.0

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    @property
    def memory(self) -> int:
        """Bytes of main memory that the child holds; 0 where that cannot be read."""
        try:
            pages = int(Path(f"/proc/{self.pid}/statm").read_text(encoding="ascii").split()[1])
        except OSError:
            return 0
        return pages * os.sysconf("SC_PAGE_SIZE")

    @property
    def worked(self) -> float:
        """Seconds of processor time that the child has used, as far as that can be read."""
        with suppress(OSError):
            stat = Path(f"/proc/{self.pid}/stat").read_text(encoding="ascii", errors="replace")
            user, system = stat.rsplit(")", 1)[1].split()[11:13]
            self._worked = (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")
        return self._worked

    @property
    def alive(self) -> bool:
        """Whether the child still runs."""
        return self._process.poll() is None

    def send(self, message: Message) -> None:
        """Send ``message``, which the child reads when it can; raises WorkerLostError where it has ended."""
        if not self.alive:
            self._lost()
        try:
            self._pipes.write(encode(message))
        except BrokenPipeError:
            self._lost()

    def receive(self, timeout: float) -> Optional[Message]:
        """Wait up to ``timeout`` seconds for a reply, None for none; raises WorkerLostError where the child is gone."""
        try:
            message = self._pipes.next(timeout)
            while message is not None and (REACHED in message or self._unwanted):
                if REACHED in message:
                    self.reached = message[REACHED]
                else:
                    self._unwanted -= 1
                message = self._pipes.next(0.0)
        except EOFError:
            self._lost()
        return message

    def reply(self, stopped: Optional[Stopped], patience: Tuple[float, float], leaves: bool = False) -> Message:
        """Wait for the reply to a command; where it is ``stopped`` ask the child to heed that.

        After the first seconds of ``patience`` the child is asked to drop what it does, after the second ones it is
        given up: raises WorkerLostError. What ``leaves`` nothing of use is not waited for then: the reply is empty.
        """
        begin: Optional[float] = None
        self.reached = 0
        dropped = False
        while True:
            reply = self.receive(POLL)
            if reply is not None:
                return reply
            if begin is None:
                if stopped is None or not stopped():
                    continue
                begin = time.monotonic()
                self.send({"do": "interrupt"})
                if leaves:
                    self._unwanted += 1
                    return {}
            if time.monotonic() - begin >= patience[0] and not dropped:
                dropped = True
                self.send({"do": "drop"})
            if time.monotonic() - begin > patience[1]:
                raise WorkerLostError("the solver did not heed a stop, since it was grounding, and was ended")

    def kill(self) -> None:
        """End the child, whatever it does, and leave nothing of it."""
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        for pipe in (self._pipes, self._lifeline):
            pipe.close()

    def _lost(self) -> NoReturn:
        self.kill()
        code = self._process.returncode
        how = f"with exit code {code}" if code >= 0 else f"by signal {signal.Signals(-code).name}"
        raise WorkerLostError(f"the solver process ended {how}")
