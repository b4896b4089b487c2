"""Helpers for benches that run nodes: a separate master with launch files, a map on disk, a client of move_base."""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import actionlib
import numpy as np
import rosgraph
import rospy
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import MoveBaseAction
from PIL import Image

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


def write_map(folder, grid):
    """Write an OccupancyGrid as a map for map_server; return the YAML file."""
    grey = np.select([grid.cells == 100, grid.cells < 0], [0, 205], 254).astype(np.uint8)
    Image.fromarray(grey[::-1]).save(folder / "map.pgm")
    keys = f"image: map.pgm\nresolution: {grid.resolution}\norigin: [0, 0, 0]\nnegate: 0\n"
    path = folder / "map.yaml"
    path.write_text(keys + "occupied_thresh: 0.65\nfree_thresh: 0.196\n")
    return path


def pose_stamped(x, y, yaw=0.0):
    """Return a pose (m, rad) in the map."""
    stamped = PoseStamped()
    stamped.header.frame_id = "map"
    stamped.pose.position.x, stamped.pose.position.y = x, y
    stamped.pose.orientation.z, stamped.pose.orientation.w = np.sin(0.5 * yaw), np.cos(0.5 * yaw)
    return stamped


def move_base_client():
    """Return a simple action client for move_base; exit if move_base does not appear."""
    client = actionlib.SimpleActionClient("move_base", MoveBaseAction)
    wait_for(lambda: client.wait_for_server(rospy.Duration(20.0)), "move_base")
    return client
