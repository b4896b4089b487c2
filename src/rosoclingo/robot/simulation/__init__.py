"""Two-dimensional simulation of robots, sensors, doors, obstacles and packages (pure)."""

from rosoclingo.common.lazy import loader

# Public names, by the module that defines them; loaded on first use.
_NAMES = {
    "simulated_robot": "Laser Robot",
    "simulation": "Collision Simulation load_simulation",
    "spec": "Box DoorSpec LaserSpec ObstacleSpec RobotSpec WorldError WorldSpec",
    "world_file": "load_world",
}

_MODULES = {name: module for module, names in _NAMES.items() for name in names.split()}
__all__ = [*_MODULES]
__getattr__ = loader(__name__, _MODULES)
