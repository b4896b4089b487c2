"""The two-dimensional world: robots, sensors, doors, obstacles, packages (pure)."""

from rosoclingo.simulation.robot import Laser, Robot
from rosoclingo.simulation.simulation import Collision, Simulation, load_simulation
from rosoclingo.simulation.spec import (
    Box,
    DoorSpec,
    LaserSpec,
    ObstacleSpec,
    PackageSpec,
    RobotSpec,
    WorldSpec,
)
from rosoclingo.simulation.world_file import load_world
from rosoclingo.simulation.world_reader import WorldError

__all__ = [
    "Box",
    "Collision",
    "DoorSpec",
    "Laser",
    "LaserSpec",
    "ObstacleSpec",
    "PackageSpec",
    "Robot",
    "RobotSpec",
    "Simulation",
    "WorldError",
    "WorldSpec",
    "load_simulation",
    "load_world",
]
