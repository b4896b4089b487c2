"""Compiles all numerical loops: ``python3 -m rosoclingo.robot.nodes.compiling FOLDER...``.

The build runs this and copies the compiled code into FOLDER.
"""

import contextlib
import os
import shutil
import sys
from pathlib import Path
from typing import Callable

import numpy as np

from rosoclingo.robot.navigation.compiled.jit import FOLDER
from rosoclingo.robot.navigation.costmap import Costmap, CostmapLimits
from rosoclingo.robot.navigation.follower import RolloutFollower
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import OccupancyGrid
from rosoclingo.robot.navigation.grid_planner import GridPlanner
from rosoclingo.robot.navigation.local_planner import Velocity, path_radii
from rosoclingo.robot.navigation.navigator import Navigator
from rosoclingo.robot.simulation.simulation import Simulation
from rosoclingo.robot.simulation.spec import Box, DoorSpec, ObstacleSpec, RobotSpec, WorldSpec

FOOTPRINT = ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2))  # m


def compile_once(part: str, log: Callable[[str], None]) -> None:
    """Compile one of PARTS. If it has not been compiled yet, ``log`` a message first."""
    mark = Path(FOLDER, f"{part}.compiled")
    if not mark.exists():
        log(f"compiling {part} once, which takes up to a minute; the compiled code is cached in {FOLDER}")
    PARTS[part]()
    with contextlib.suppress(OSError):  # without a writable folder every process compiles
        mark.touch()


def _room() -> OccupancyGrid:
    """Return a room of 4 m by 3 m with a wall in it."""
    cells = np.zeros((60, 80), dtype=np.int8)
    cells[:2] = cells[-2:] = cells[:, :2] = cells[:, -2:] = 100
    cells[20:45, 39:41] = 100
    return OccupancyGrid(cells, 0.05)


def _navigate() -> None:
    """Call each compiled function for a disc and for a footprint."""
    angles, pose = np.linspace(-1.0, 1.0, 20), Pose2D(1.0, 1.5, 0.0)
    for footprint in ((), FOOTPRINT):
        costmap = Costmap(_room(), CostmapLimits(path_radii=path_radii(0.2, footprint)))
        follower = RolloutFollower(radius=0.2, footprint=footprint)
        navigator = Navigator(costmap, GridPlanner(), follower, [])
        costmap.observe(pose, angles, np.full(20, 0.5), 5.0)  # hits that are not marked yet, for braking
        for x in (3.0, 0.3):  # the second goal is next to a wall
            navigator.set_goal(0.0, Pose2D(x, 1.5, 1.0))
            navigator.tick(0.0, pose, Velocity(), 0.1)
            navigator.obstacles_changed()
            navigator.tick(2.0, pose, Velocity(), 0.1)  # plans again, and checks the present path
            follower.can_turn(costmap, pose, 1.0)
        for _ in range(4):
            costmap.observe(pose, angles, np.full(20, 0.5), 5.0)
            follower.compute(costmap, pose, Velocity(), 4.0)  # a long period, so that the robot creeps


def _simulate() -> None:
    """Step and scan a world with a disc, a footprint, a door, a box and a post."""
    robots = (RobotSpec("disc", Pose2D(1.0, 1.0)), RobotSpec("corners", Pose2D(1.7, 1.0), footprint=FOOTPRINT))
    things = (ObstacleSpec("box", (1.0, 2.0), box=Box(0.2, 0.2)), ObstacleSpec("post", (1.7, 2.0), radius=0.1))
    door = DoorSpec("door", (1.4, 0.0), (1.4, 0.5), open=False)
    world = Simulation(WorldSpec(_room(), robots, (door,), things))
    for name in world.robots:
        world.scan(name)
        world.command(name, 0.1, 0.1)
    world.step()


#: Parts with compiled functions. Each entry calls all functions of the part with all argument types.
PARTS = {"navigation": _navigate, "simulation": _simulate}


def main() -> None:
    """Compile all parts, and copy the compiled code to the folders of the command line."""
    for part in PARTS:
        compile_once(part, print)
    for folder in sys.argv[1:]:
        target = Path(folder, os.path.basename(FOLDER))
        shutil.rmtree(str(target), ignore_errors=True)
        shutil.copytree(FOLDER, str(target))


if __name__ == "__main__":
    main()
