"""The two-dimensional world: robots, sensors, doors, obstacles, packages (pure)."""

from rosoclingo.common.lazy import loader

# The names of each module that the package has as well.
_NAMES = {
    "simulated_robot": "Laser Robot",
    "simulation": "Collision Simulation load_simulation",
    "spec": "Box DoorSpec LaserSpec ObstacleSpec PackageSpec RobotSpec WorldError WorldSpec",
    "world_file": "load_world",
}

_MODULES = {name: module for module, names in _NAMES.items() for name in names.split()}
__all__ = [*_MODULES]
__getattr__ = loader(__name__, _MODULES)
