"""Compiles everything once, before anybody waits for it: ``python3 -m rosoclingo.robot.nodes.compiling FOLDER...``.

The build does that, and has a copy put into each folder.
"""

import contextlib
import fcntl
import os
import shutil
import sys
from pathlib import Path
from typing import Callable, Iterator

import numpy as np

from rosoclingo.robot.navigation import (
    Costmap,
    CostmapLimits,
    GridPlanner,
    Navigator,
    OccupancyGrid,
    Pose2D,
    RolloutFollower,
    Velocity,
)
from rosoclingo.robot.navigation.body import Body
from rosoclingo.robot.navigation.compiled.jit import FOLDER
from rosoclingo.robot.navigation.local_planner import way_radii
from rosoclingo.robot.navigation.way_out import WayOut
from rosoclingo.robot.simulation import Box, DoorSpec, ObstacleSpec, RobotSpec, Simulation, WorldSpec

__all__ = ["PARTS", "compile_once"]

FOOTPRINT = ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2))  # m


def compile_once(part: str, say: Callable[[str], None]) -> None:
    """Have all functions of one of PARTS ready to be called; ``say`` so first where they have to be compiled.

    Another process that compiles the same is waited for.
    """
    mark = Path(FOLDER, f"{part}.compiled")
    with _alone(part):
        known = mark.exists()
        if not known:
            say(f"compiling {part} once, which takes up to a minute; what was compiled is kept in {FOLDER}")
        PARTS[part]()
        if not known:
            with contextlib.suppress(OSError):  # without a folder it is compiled every time
                mark.touch()


@contextlib.contextmanager
def _alone(part: str) -> Iterator[None]:
    """Be the only process that compiles a part; without a folder there is nothing to share."""
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError):
            file = stack.enter_context(Path(FOLDER, f"{part}.lock").open("w"))
            fcntl.flock(file, fcntl.LOCK_EX)
        yield


def _room() -> OccupancyGrid:
    """Return a room of 4 m by 3 m with a wall in it."""
    cells = np.zeros((60, 80), dtype=np.int8)
    cells[:2] = cells[-2:] = cells[:, :2] = cells[:, -2:] = 100
    cells[20:45, 39:41] = 100
    return OccupancyGrid(cells, 0.05)


def _navigate() -> None:
    """Drive a disc and a robot with corners, in thought, with scans that show something."""
    angles, pose = np.linspace(-1.0, 1.0, 20), Pose2D(1.0, 1.5, 0.0)
    for footprint in ((), FOOTPRINT):
        costmap = Costmap(_room(), CostmapLimits(way_radii=way_radii(0.2, footprint)))
        follower = RolloutFollower(radius=0.2, footprint=footprint)
        navigator = Navigator(costmap, GridPlanner(), follower, [])
        for x in (3.0, 0.3):  # the latter next to the wall
            navigator.set_goal(0.0, Pose2D(x, 1.5, 1.0))
            navigator.tick(0.0, pose, Velocity(), 0.1)
            follower.may_turn(costmap, pose, 1.0)
        costmap.bar(2.0, 2.5)
        for _ in range(5):
            costmap.observe(pose, angles, np.full(20, 0.5), 5.0)
            follower.compute(costmap, pose, Velocity(), 4.0)  # so long that it tries to creep
        body = Body(0.2, footprint)
        WayOut(0.1).begin(body, body.situation(costmap, pose, Velocity(), 0.1))
        costmap.costs()


def _simulate() -> None:
    """Let a disc and a robot with corners see, move and stand among a door, a box and a post."""
    robots = (RobotSpec("disc", Pose2D(1.0, 1.0)), RobotSpec("corners", Pose2D(1.7, 1.0), footprint=FOOTPRINT))
    things = (ObstacleSpec("box", (1.0, 2.0), box=Box(0.2, 0.2)), ObstacleSpec("post", (1.7, 2.0), radius=0.1))
    door = DoorSpec("door", (1.4, 0.0), (1.4, 0.5), open=False)
    world = Simulation(WorldSpec(_room(), robots, (door,), things))
    for name in world.robots:
        world.scan(name)
        world.command(name, 0.1, 0.1)
    world.step()


#: What has compiled functions, and what calls each of them with each kind of argument.
PARTS = {"navigation": _navigate, "simulation": _simulate}


def main() -> None:
    """Compile all parts, and put a copy into each folder."""
    for part in PARTS:
        compile_once(part, print)
    for folder in sys.argv[1:]:
        target = Path(folder, os.path.basename(FOLDER))
        shutil.rmtree(str(target), ignore_errors=True)
        shutil.copytree(FOLDER, str(target))


if __name__ == "__main__":
    main()
