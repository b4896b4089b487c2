"""The two-dimensional world: robots, sensors, doors, obstacles, packages (pure)."""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
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

# Loaded when asked for: numba takes a second, and not everybody who wants a pose drives robots.
_HOMES = {
    "Box": "spec",
    "Collision": "simulation",
    "DoorSpec": "spec",
    "Laser": "robot",
    "LaserSpec": "spec",
    "ObstacleSpec": "spec",
    "PackageSpec": "spec",
    "Robot": "robot",
    "RobotSpec": "spec",
    "Simulation": "simulation",
    "WorldError": "world_reader",
    "WorldSpec": "spec",
    "load_simulation": "simulation",
    "load_world": "world_file",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
