"""Commands with a time limit, of which nothing is left when they have ended."""

import os
import signal
import subprocess
import time
import uuid
from pathlib import Path
from typing import Iterator, List, Mapping, NamedTuple, Optional, Sequence

ROOT = Path(__file__).resolve().parent.parent
MARK = "ROSOCLINGO_TEST_RUN"  # an environment variable: by it a test's processes are known


class Finished(NamedTuple):
    """A command that ended: its exit code (None if it had to be ended), the processes it left behind, and its CPU time.

    The time is in seconds, its own and that of all that it started and waited for.
    """

    code: Optional[int]
    leftovers: List[str]
    computed: float = 0.0


def processes_with(mark: str) -> Iterator[int]:
    """The processes that were started with the mark in their environment."""
    needle = f"{MARK}={mark}".encode()
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and int(entry.name) != os.getpid():
            try:
                if needle in (entry / "environ").read_bytes().split(b"\0"):
                    yield int(entry.name)
            except OSError:  # ended meanwhile, or another user's
                continue


def command_line(pid: int) -> str:
    """The command line of a process, empty for one that is a zombie or gone."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()
    except OSError:
        return ""


def end_leftovers(mark: str, grace: float = 30.0) -> List[str]:
    """Ends what is still there of a run after a grace time, in seconds; returns the command lines."""
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
    """Wait for a child's end, and leave it to be reaped; its CPU time in seconds, None where it goes on."""
    deadline = time.monotonic() + limit
    while not os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT):
        if time.monotonic() > deadline:
            return None
        time.sleep(0.05)
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")  # utime to cstime of proc(5)


def _interrupt(process: "subprocess.Popen[bytes]") -> None:
    process.send_signal(signal.SIGINT)
    try:
        process.wait(20)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def run(command: Sequence[str], log: Path, limit: float, environment: Mapping[str, str]) -> Finished:
    """Runs a command with a time limit in seconds and its output in a log, and sees that nothing is left of it."""
    mark = uuid.uuid4().hex
    variables = {**environment, MARK: mark}
    with log.open("wb") as output:
        process = subprocess.Popen(
            command, cwd=ROOT, env=variables, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT
        )
        try:
            computed = _wait(process.pid, limit)
            if computed is None:
                _interrupt(process)
            code = None if computed is None else process.wait()
        finally:
            if process.poll() is None:
                process.kill()
            leftovers = end_leftovers(mark)
    return Finished(code, leftovers, computed or 0.0)
