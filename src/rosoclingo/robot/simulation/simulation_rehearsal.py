"""A rehearsal of everything that is compiled for the simulation: afterwards a world has nothing left to compile."""

import numpy as np

from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import OccupancyGrid
from rosoclingo.robot.simulation.simulation import Simulation
from rosoclingo.robot.simulation.spec import Box, DoorSpec, ObstacleSpec, RobotSpec, WorldSpec

__all__ = ["rehearse"]

FOOTPRINT = ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2))


def rehearse() -> None:
    """Let a disc and a robot with corners see, move and stand among a door, a box and a post in a small world."""
    cells = np.zeros((60, 60), dtype=np.int8)
    cells[:2] = cells[-2:] = cells[:, :2] = cells[:, -2:] = 100
    robots = (RobotSpec("disc", Pose2D(1.0, 1.0)), RobotSpec("corners", Pose2D(2.0, 1.0), footprint=FOOTPRINT))
    things = (ObstacleSpec("box", (1.0, 2.0), box=Box(0.2, 0.2)), ObstacleSpec("post", (2.0, 2.0), radius=0.1))
    door = DoorSpec("door", (1.5, 0.0), (1.5, 0.5), open=False)
    world = Simulation(WorldSpec(OccupancyGrid(cells, 0.05), robots, (door,), things))
    for name in ("disc", "corners"):
        world.scan(name)
        world.command(name, 0.1, 0.1)
    world.step()
