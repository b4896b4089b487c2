"""Starts and ends worker processes: new processes, or forks of this one."""

import os
import pickle
import signal
import sys
import traceback
from contextlib import suppress
from multiprocessing.connection import Connection, Pipe
from typing import Any, Mapping, Optional

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.workers.protocol import CONNECTION, PROGRAM


class WorkerProcess:
    """A child process that executes commands from a connection.

    The child has its own session, so that Ctrl-C in the terminal does not reach it. Its standard input is a lifeline:
    the pipe closes when this process ends, and that ends the child.

    Attributes:
        connection: the connection to the child.
        pid: process id.

    """

    def __init__(self, program: ReactiveProgram, options: Mapping[str, Any], fork: bool) -> None:
        """Start a new process with ``program``, or a ``fork`` of this process; raises OSError.

        A fork starts in milliseconds, because it shares all loaded modules and the program. This process must have no
        threads then: the fork would copy their locks, which are never released. For ``options`` see
        :class:`~rosoclingo.planning.workers.pool.WorkerPool`.
        """
        self.connection, theirs = Pipe()
        lifeline, self._lifeline = os.pipe()
        self._exit_code: Optional[int] = None
        try:
            self.pid = (_fork if fork else _spawn)(program, options, theirs, lifeline)
        except OSError:
            os.close(self._lifeline)
            self.connection.close()
            raise
        finally:
            os.close(lifeline)
            theirs.close()

    @property
    def exit_code(self) -> Optional[int]:
        """The exit code, or minus the number of the signal that ended the process; None while it runs."""
        return self._wait(os.WNOHANG)

    def kill(self) -> int:
        """Kill the process unless it has ended, and close the connection; return the exit code."""
        self.connection.close()
        if self.exit_code is None:
            os.kill(self.pid, signal.SIGKILL)
        code = self._wait(0)
        assert code is not None
        return code

    def _wait(self, options: int) -> Optional[int]:
        if self._exit_code is None:
            try:
                ended, status = os.waitpid(self.pid, options)
            except ChildProcessError:  # this process ignores SIGCHLD, so the exit code is lost
                ended, status = self.pid, 0
            if ended:
                self._exit_code = -os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)
                os.close(self._lifeline)
        return self._exit_code


def _spawn(program: ReactiveProgram, options: Mapping[str, Any], connection: Connection, lifeline: int) -> int:
    """Start a new process; return its process id."""
    constants = {name: str(value) for name, value in program.constants.items()}
    with os.fdopen(os.memfd_create("program"), "w+b") as file:  # the disk can be full
        pickle.dump(([*program.texts], constants, options), file)
        file.seek(0)
        return os.posix_spawn(
            sys.executable,
            [sys.executable, "-m", "rosoclingo.planning.workers.worker_main"],
            dict(os.environ, PYTHONPATH=os.pathsep.join(filter(None, sys.path))),
            file_actions=[
                (os.POSIX_SPAWN_DUP2, lifeline, 0),
                (os.POSIX_SPAWN_DUP2, connection.fileno(), CONNECTION),
                (os.POSIX_SPAWN_DUP2, file.fileno(), PROGRAM),
            ],
            setsid=True,
        )


def _fork(program: ReactiveProgram, options: Mapping[str, Any], connection: Connection, lifeline: int) -> int:
    """Start a fork of this process; return its process id.

    The child executes commands and exits, without flushing buffers that the parent has not written yet.
    """
    pid = os.fork()
    if pid:
        return pid
    code = 1
    try:
        from rosoclingo.planning.workers.worker_main import work  # noqa: PLC0415 other parents do not need it

        os.setsid()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_DFL)
        os.dup2(lifeline, 0)
        for file in map(int, os.listdir("/proc/self/fd")):
            if file > 2 and file != connection.fileno():
                with suppress(OSError):  # the descriptor of the folder itself is closed already
                    os.close(file)
        work(connection, lambda: program, options)
        code = 0
    except BaseException:  # noqa: BLE001 the child must not continue the code of the parent
        os.write(2, traceback.format_exc().encode())
    finally:
        os._exit(code)
