"""Processes of solvers in tests: how they are ended, and known to have."""

import os
import signal
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from rosoclingo.planning.workers import worker
from rosoclingo.planning.workers.pool import WorkerPool


def ended(pid):
    """Whether a process has ended, waited for."""
    for _ in range(1200):
        try:
            fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
        except OSError:  # it goes between the opening of the file and the reading, too
            return True
        if fields[0] == "Z" and int(fields[17]) <= 1:  # the first of its threads may have ended before the others
            return True
        threading.Event().wait(0.05)
    return False


def kill(process):
    """Kill the child while it has nothing to do."""
    pid = process.pid
    os.kill(pid, signal.SIGKILL)
    assert ended(pid)


@contextmanager
def preparing_process(program):
    """A process for many tests that prepares at once, looks for shorter plans briefly, and is not replaced."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker, "GROWTH", 2**60)  # none is replaced for its size
        with WorkerPool(program, shortest=True, plan_time=0.02, standby=True) as one:
            yield one


def wait_until_prepared(process, again=lambda: None):
    """Wait until the child that is kept ready has nothing to do, asked ``again`` and again."""
    limit = time.monotonic() + 300
    while process.is_prefetching:
        assert time.monotonic() < limit
        time.sleep(0.001)
        again()
