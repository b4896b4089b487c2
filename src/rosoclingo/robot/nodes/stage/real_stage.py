"""The real Stage as the simulation's node: stageros, at a pace, with its window on a screen or on a virtual one."""

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
    """Stage cannot be started; the text says why and what to do."""


def stage_command(speed: float, window: bool, switches: Sequence[str]) -> List[str]:
    """Return the command that runs stageros, but for its world.

    Without a window (its switch -g) Stage goes as fast as it can, whatever its world file says; with one it keeps the
    world's pace. So it is given one for each pace but 0, on a virtual screen unless it is to be seen.
    """
    if speed <= 0.0 or "-g" in switches:
        return [*STAGEROS, *(["-g"] if "-g" not in switches else []), *switches]
    return [*([] if window else VIRTUAL), *STAGEROS, *switches]


def run_stage(world: str, speed: float, window: bool, switches: Sequence[str], ros: Sequence[str]) -> int:
    """Run Stage until its end; return its exit code. ``ros``: remappings and private names, as roslaunch gives them.

    Raises StageError, and WorldError for a world file that cannot be read.
    """
    try:
        rospkg.RosPack().get_path("stage_ros")
    except rospkg.ResourceNotFound as error:
        mend = "source the setup.bash of the workspace that has it, or run ./dev --overlay ITS_FOLDER ..."
        raise StageError(f"there is no package stage_ros: {mend}") from error
    command = stage_command(speed, window, switches)
    if command[0] == VIRTUAL[0] and not shutil.which(VIRTUAL[0]):
        raise StageError(
            "Stage keeps its pace only with a window, and there is no xvfb-run to hide it: install xvfb, or show it "
            "(stage_window:=true), or let it run free (speed:=0)"
        )
    text = read_stage_world(world)
    with tempfile.TemporaryDirectory(prefix="stage_") as folder:
        file = Path(folder, os.path.basename(world))
        paced = paced_world(text, os.path.dirname(world), speed if speed > 0.0 else 1.0)
        file.write_text(paced, encoding="utf-8", errors="surrogateescape")
        return run_command([*command, str(file), *ros])


def run_command(command: Sequence[str]) -> int:
    """Run a command, and hand over what ends this process; return its exit code, as a shell has it."""
    processes: List[subprocess.Popen] = []
    early: List[int] = []

    def hand_over(number: int, _frame: object) -> None:
        """Send a signal on, once there is a process."""
        for process in processes:
            process.send_signal(number)
        if not processes:
            early.append(number)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, hand_over)  # before there is a process: what ends this one may come at once
    process = subprocess.Popen(list(command))
    processes.append(process)
    for number in early:
        process.send_signal(number)
    code = process.wait()
    return code if code >= 0 else 128 - code
