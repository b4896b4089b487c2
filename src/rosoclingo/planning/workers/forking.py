"""Workers that are copies of this process."""

import os
import signal
import socket
import traceback
from contextlib import suppress
from functools import partial
from typing import Callable, NoReturn, Optional

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram


class ForkedProcess:
    """A copy of this process that runs a function, with the interface of :class:`subprocess.Popen`.

    It starts in milliseconds, as it shares all that is loaded. The parent must have no threads: the child has copies of
    their locks, which nobody releases.

    Attributes:
        pid: process id.
        stdin: the parent's end of the child's standard input.
        returncode: the exit code, or minus the number of the signal that ended it; None while it is not known to have
            ended.

    """

    def __init__(self, run: Callable[[], object], kept: int) -> None:
        """Start the child in a session of its own; of the open files it has the standard streams and ``kept``."""
        child_end, parent_end = os.pipe()
        self.pid = os.fork()
        if not self.pid:
            _run(run, child_end, kept)
        os.close(child_end)
        self.stdin = open(parent_end, "wb")  # noqa: SIM115 its owner closes it
        self.returncode: Optional[int] = None

    def poll(self) -> Optional[int]:
        """Return the exit code, None while it runs."""
        return self._wait(os.WNOHANG)

    def wait(self) -> int:
        """Wait until it has ended; return the exit code."""
        code = self._wait(0)
        assert code is not None
        return code

    def kill(self) -> None:
        """Kill it unless it has ended."""
        if self.poll() is None:
            os.kill(self.pid, signal.SIGKILL)

    def _wait(self, options: int) -> Optional[int]:
        if self.returncode is None:
            try:
                ended, status = os.waitpid(self.pid, options)
            except ChildProcessError:  # this process ignores SIGCHLD: nobody knows the exit code
                ended, status = self.pid, 0
            if ended:
                self.returncode = -os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)
        return self.returncode


def _run(run: Callable[[], object], stdin: int, kept: int) -> NoReturn:
    """Be the child: call ``run`` and end. What the parent has not written yet stays the parent's."""
    code = 1
    try:
        os.setsid()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_DFL)
        os.dup2(stdin, 0)
        for file in map(int, os.listdir("/proc/self/fd")):
            if file > 2 and file != kept:
                with suppress(OSError):  # that of the folder itself
                    os.close(file)
        with suppress(SystemExit):
            run()
        code = 0
    except BaseException:  # noqa: BLE001 the child must not go on with what the parent was doing
        os.write(2, traceback.format_exc().encode())
    finally:
        os._exit(code)


def fork_worker(connection: socket.socket, program: ReactiveProgram) -> ForkedProcess:
    """Start a worker with a ``program`` for the commands that come by ``connection``; raises OSError."""
    from rosoclingo.planning.workers.worker_main import work  # noqa: PLC0415 parents of other workers do not need it

    return ForkedProcess(partial(work, connection, program), connection.fileno())
