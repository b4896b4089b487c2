"""The nodes of a bench: a separate master with launch files."""

import os
import signal
import socket
import subprocess

import rosgraph
from waiting import wait_until


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
        wait_until(rosgraph.is_master_online, "the master")
        rosgraph.Master("bench").setParam("/use_sim_time", simulated)  # before a process reads the time

    def __enter__(self):
        return self

    def __exit__(self, *error):
        for process in reversed(self.processes):
            process.send_signal(signal.SIGINT)
        for process in self.processes:
            process.wait(timeout=30)

    def start(self, *command, namespace="/"):
        """Start a process in a namespace."""
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self.processes.append(subprocess.Popen(command, env={**os.environ, "ROS_NAMESPACE": namespace}, **quiet))

    def launch(self, name, *arguments, namespace="/"):
        """Start a launch file of this package."""
        self.start("roslaunch", "--wait", "rosoclingo", name, *arguments, namespace=namespace)
