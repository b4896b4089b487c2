"""Runs stageros at a given speed, with its window on a screen or on a virtual screen."""

import os
import shutil
import signal
import subprocess
import tempfile
from pathlib import Path
from typing import List, Sequence

import rospkg

from rosoclingo.robot.simulation.stage_pace import paced_world, read_stage_world

STAGEROS = ["rosrun", "stage_ros", "stageros"]
VIRTUAL = ["xvfb-run", "-a", "-s", "-screen 0 800x600x24"]


class StageError(RuntimeError):
    """Stage cannot be started. The text gives the reason and a remedy."""


def stage_command(speed: float, window: bool, switches: Sequence[str]) -> List[str]:
    """Return the command for stageros, without its world file.

    Stage keeps the pace of its world file only if it has a window; without one (switch -g) it runs as fast as it can.
    For any speed but 0 it therefore gets a window, on a virtual screen unless ``window`` is set.
    """
    if speed <= 0.0 or "-g" in switches:
        return [*STAGEROS, *(["-g"] if "-g" not in switches else []), *switches]
    return [*([] if window else VIRTUAL), *STAGEROS, *switches]


def run_stage(world: str, speed: float, window: bool, switches: Sequence[str], ros: Sequence[str]) -> int:
    """Run Stage and return its exit code. ``ros``: remappings and private names, as from roslaunch.

    Raises StageError, and WorldError for a world file that cannot be read.
    """
    try:
        rospkg.RosPack().get_path("stage_ros")
    except rospkg.ResourceNotFound as error:
        remedy = "source the setup.bash of its workspace, or run ./dev --overlay WORKSPACE ..."
        raise StageError(f"there is no package stage_ros: {remedy}") from error
    command = stage_command(speed, window, switches)
    if command[0] == VIRTUAL[0] and not shutil.which(VIRTUAL[0]):
        raise StageError(
            "Stage keeps its pace only with a window, and there is no xvfb-run to hide it: install xvfb, show the "
            "window (stage_window:=true) or run as fast as possible (speed:=0)"
        )
    text = read_stage_world(world)
    with tempfile.TemporaryDirectory(prefix="stage_") as folder:
        file = Path(folder, os.path.basename(world))
        paced = paced_world(text, os.path.dirname(world), speed if speed > 0.0 else 1.0)
        file.write_text(paced, encoding="utf-8", errors="surrogateescape")
        return run_command([*command, str(file), *ros])


def run_command(command: Sequence[str]) -> int:
    """Run a command, forwarding SIGINT and SIGTERM to it. Return its exit code as a shell would."""
    processes: List[subprocess.Popen] = []
    early: List[int] = []

    def forward(number: int, _frame: object) -> None:
        """Forward a signal; store it if there is no process yet."""
        for process in processes:
            process.send_signal(number)
        if not processes:
            early.append(number)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, forward)  # before the process starts, so that no signal is lost
    process = subprocess.Popen(list(command))
    processes.append(process)
    for number in early:
        process.send_signal(number)
    code = process.wait()
    return code if code >= 0 else 128 - code
