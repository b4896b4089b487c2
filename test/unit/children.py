"""Processes of solvers in tests: how they are ended, and known to have."""

import os
import signal
import threading
from pathlib import Path


def ended(pid):
    """Whether a process has ended, waited for."""
    for _ in range(1200):
        try:
            state = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()[0]
        except OSError:  # it goes between the opening of the file and the reading, too
            return True
        if state == "Z":
            return True
        threading.Event().wait(0.05)
    return False


def kill(process):
    """Kill the child while it has nothing to do."""
    pid = process.pid
    os.kill(pid, signal.SIGKILL)
    assert ended(pid)
