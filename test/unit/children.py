"""Worker processes in tests: waiting for them, and killing them."""

import os
import signal
import threading
import time
from contextlib import contextmanager
from pathlib import Path

from rosoclingo.planning.workers.pool import WorkerPool


def ended(pid):
    """Wait up to a minute and return whether a process has ended."""
    for _ in range(1200):
        try:
            fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
        except OSError:  # the process can also end between opening and reading the file
            return True
        if fields[0] == "Z" and int(fields[17]) <= 1:  # its first thread can have ended before the others
            return True
        threading.Event().wait(0.05)
    return False


def kill(process):
    """Kill an idle worker and wait for its end."""
    pid = process.pid
    os.kill(pid, signal.SIGKILL)
    assert ended(pid)


@contextmanager
def preparing_process(program):
    """Yield a pool for many tests that prefetches, improves plans only briefly, and keeps its workers."""
    with WorkerPool(program, shortest=True, plan_time=0.02, standby=True, growth=2**60) as one:
        yield one


def wait_until_prepared(process, again=lambda: None):
    """Wait until the standby worker is idle; ``again`` is called before each poll."""
    limit = time.monotonic() + 300
    while process.is_prefetching:
        assert time.monotonic() < limit
        time.sleep(0.001)
        again()
