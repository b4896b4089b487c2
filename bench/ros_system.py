"""Helpers for benches that run nodes: a separate master, launch files, a map on disk, a client of move_base."""

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import rosgraph
from PIL import Image

PATIENCE = 60.0  # s of wall time for a node to appear


class System:
    """A master on a free port and the processes started on it; :meth:`stop` ends them."""

    def __init__(self) -> None:
        with socket.socket() as free:
            free.bind(("", 0))
            port = free.getsockname()[1]
        os.environ["ROS_MASTER_URI"] = f"http://localhost:{port}"
        self.processes = []
        self.start("roscore", "-p", str(port))
        deadline = time.monotonic() + PATIENCE
        while not rosgraph.is_master_online() and time.monotonic() < deadline:
            time.sleep(0.1)

    def start(self, *command: str) -> None:
        self.processes.append(subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))

    def launch(self, name: str, *arguments: str) -> None:
        """Start a launch file of this package."""
        self.start("roslaunch", "rosoclingo", name, *arguments, "--wait")

    def stop(self) -> None:
        for process in reversed(self.processes):
            process.send_signal(signal.SIGINT)
        for process in self.processes:
            process.wait(timeout=30)


def write_map(folder: Path, grid) -> Path:
    """Write an OccupancyGrid as a map for map_server; return the YAML file."""
    grey = np.select([grid.cells == 100, grid.cells < 0], [0, 205], 254).astype(np.uint8)
    Image.fromarray(grey[::-1]).save(folder / "map.pgm")
    keys = f"image: map.pgm\nresolution: {grid.resolution}\norigin: [0, 0, 0]\nnegate: 0\n"
    path = folder / "map.yaml"
    path.write_text(keys + "occupied_thresh: 0.65\nfree_thresh: 0.196\n")
    return path


def move_base_client(kind, prefix: str = ""):
    """Return an action client of the class ``kind`` for move_base; exit if move_base does not appear."""
    import rospy
    from move_base_msgs.msg import MoveBaseAction

    client = kind(prefix + "move_base", MoveBaseAction)
    deadline = time.monotonic() + PATIENCE
    while not client.wait_for_server(rospy.Duration(20.0)):
        if time.monotonic() > deadline:
            sys.exit(f"move_base did not appear within {PATIENCE:g} s")
    return client
