"""Commands with a time limit, which leave no process behind."""

import os
import signal
import subprocess
import threading
import time
import uuid
from pathlib import Path
from typing import Iterator, List, Mapping, NamedTuple, Optional, Sequence

ROOT = Path(__file__).resolve().parent.parent
MARK = "ROSOCLINGO_TEST_RUN"  # an environment variable that marks a test's processes
_INTERRUPTED = threading.Event()


class Finished(NamedTuple):
    """A command that ended: its exit code (None if it was killed), its leftover processes, and its CPU time.

    The time is in seconds, for the command and for all processes that it started and waited for.
    """

    code: Optional[int]
    leftovers: List[str]
    computed: float = 0.0


def end_on_interrupt() -> None:
    """Let SIGINT end the commands of all threads: each `run` raises KeyboardInterrupt.

    A shell that starts this process in the background has SIGINT ignored, which the commands would inherit.
    """
    signal.signal(signal.SIGINT, lambda *_: _INTERRUPTED.set())


def check_interrupt() -> None:
    """Raise KeyboardInterrupt after a SIGINT."""
    if _INTERRUPTED.is_set():
        raise KeyboardInterrupt


def processes_with(mark: str) -> Iterator[int]:
    """Return the processes that were started with the mark in their environment."""
    needle = f"{MARK}={mark}".encode()
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and int(entry.name) != os.getpid():
            try:
                if needle in (entry / "environ").read_bytes().split(b"\0"):
                    yield int(entry.name)
            except OSError:  # it has ended meanwhile, or belongs to another user
                continue


def command_line(pid: int) -> str:
    """Return the command line of a process, empty for a zombie or an ended process."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()
    except OSError:
        return ""


def end_leftovers(mark: str, grace: float = 30.0) -> List[str]:
    """End the remaining processes of a run after a grace time, in seconds; return their command lines."""
    deadline = time.monotonic() + grace
    while time.monotonic() < deadline and any(command_line(pid) for pid in processes_with(mark)):
        time.sleep(0.1)
    names = []
    for pid in processes_with(mark):
        if command_line(pid):
            names.append(command_line(pid))
            os.kill(pid, signal.SIGKILL)
    return names


def _wait(pid: int, limit: float) -> Optional[float]:
    """Wait for a child's end, without reaping it; return its CPU time in seconds, None if it goes on.

    Raises KeyboardInterrupt.
    """
    deadline = time.monotonic() + limit
    while not os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT):
        check_interrupt()
        if time.monotonic() > deadline:
            return None
        time.sleep(0.05)
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")  # utime to cstime of proc(5)


def _end(process: "subprocess.Popen[bytes]") -> None:
    """Interrupt a process if it still runs, and kill it if that has no effect."""
    process.send_signal(signal.SIGINT)
    try:
        process.wait(20)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def run(command: Sequence[str], log: Path, limit: float, environment: Mapping[str, str]) -> Finished:
    """Run a command with a time limit in seconds and its output in a log, and leave no process of it behind.

    Raises KeyboardInterrupt.
    """
    check_interrupt()
    mark = uuid.uuid4().hex
    variables = {**environment, MARK: mark}
    with log.open("wb") as output:
        process = subprocess.Popen(
            command, cwd=ROOT, env=variables, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT
        )
        try:
            computed = _wait(process.pid, limit)
            code = None if computed is None else process.wait()
        finally:
            _end(process)
            leftovers = end_leftovers(mark)
    return Finished(code, leftovers, computed or 0.0)
