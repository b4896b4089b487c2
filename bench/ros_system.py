"""The nodes of a bench: a separate master with launch files."""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import rosgraph

PATIENCE = 60.0  # s of wall time for a node to appear


class System:
    """A master on a free port, in ``simulated`` time or not, and processes, which end with the context."""

    def __init__(self, simulated=False):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = str(free.getsockname()[1])
        os.environ.update(ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1")
        os.environ.pop("ROS_HOSTNAME", None)
        self.processes = []
        self.start("roscore", "-p", port)
        wait_for(rosgraph.is_master_online, "the master")
        rosgraph.Master("bench").setParam("/use_sim_time", simulated)  # before a process reads the time

    def __enter__(self):
        return self

    def __exit__(self, *error):
        for process in reversed(self.processes):
            process.send_signal(signal.SIGINT)
        for process in self.processes:
            process.wait(timeout=30)

    def start(self, *command, namespace="/", **options):
        """Start a process in a namespace; return it."""
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, **options}
        self.processes.append(subprocess.Popen(command, env={**os.environ, "ROS_NAMESPACE": namespace}, **quiet))
        return self.processes[-1]

    def launch(self, name, *arguments, namespace="/"):
        """Start a launch file of this package."""
        return self.start("roslaunch", "--wait", "rosoclingo", name, *arguments, namespace=namespace)

    def call(self, module, call, **options):
        """Start a process that calls a function of a bench; return it."""
        folder = str(Path(__file__).resolve().parent)
        code = f"import sys; sys.path.insert(0, {folder!r}); import {module}; {module}.{call}"
        return self.start(sys.executable, "-c", code, **options)


def wait_for(condition, what):
    """Wait until ``condition`` returns true; exit if it does not."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > deadline:
            sys.exit(f"{what} did not appear within {PATIENCE:g} s")
        time.sleep(0.05)
