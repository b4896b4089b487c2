"""The two-dimensional world: robots, sensors, doors, obstacles, packages (pure)."""

from typing import TYPE_CHECKING

from rosoclingo.common.lazy import loader

if TYPE_CHECKING:
    from rosoclingo.robot.simulation.simulated_robot import Laser, Robot
    from rosoclingo.robot.simulation.simulation import Collision, Simulation, load_simulation
    from rosoclingo.robot.simulation.spec import (
        Box,
        DoorSpec,
        LaserSpec,
        ObstacleSpec,
        PackageSpec,
        RobotSpec,
        WorldError,
        WorldSpec,
    )
    from rosoclingo.robot.simulation.world_file import load_world

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

__getattr__ = loader(
    __name__,
    {
        "Box": "spec",
        "Collision": "simulation",
        "DoorSpec": "spec",
        "Laser": "simulated_robot",
        "LaserSpec": "spec",
        "ObstacleSpec": "spec",
        "PackageSpec": "spec",
        "Robot": "simulated_robot",
        "RobotSpec": "spec",
        "Simulation": "simulation",
        "WorldError": "spec",
        "WorldSpec": "spec",
        "load_simulation": "simulation",
        "load_world": "world_file",
    },
)
