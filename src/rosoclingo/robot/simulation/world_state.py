"""State of a simulated world as plain values, from which a new process can resume after a crash."""

from typing import Any, Dict, Tuple

from rosoclingo.common.reading import Reader
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.simulation.simulation import Simulation
from rosoclingo.robot.simulation.spec import Box, ObstacleSpec, WorldError


def world_state(simulation: Simulation) -> Dict[str, Any]:
    """Return the present state as numbers, texts, lists and mappings (m, rad).

    ``robots`` contains pose and odometry (x, y, yaw each), ``doors`` whether they are open, ``obstacles`` x, y and a
    radius, or x, y, width, depth and yaw. Time and velocities are not included.
    """
    return {
        "robots": {name: [*map(float, robot.pose + robot.odometry)] for name, robot in simulation.robots.items()},
        "doors": {name: door.open for name, door in simulation.doors.items()},
        "obstacles": {
            name: [*map(float, one.at + (one.box or (one.radius,)))] for name, one in simulation.obstacles.items()
        },
    }


def resume_world(simulation: Simulation, kept: Reader) -> None:
    """Restore a new world to a state, with robots at rest.

    Raises WorldError if the state does not fit this world, which then stays as it is.
    """
    robots = {name: _two_poses(item) for name, item in kept.at("robots").entries()}
    doors = {name: item.flag() for name, item in kept.at("doors").entries()}
    obstacles = {name: _obstacle(name, item) for name, item in kept.at("obstacles").entries()}
    kept.check(WorldError)
    for known, found, what in ((simulation.robots, robots, "robots"), (simulation.doors, doors, "doors")):
        if known.keys() != found.keys():
            raise WorldError("the {} are {}, not {}".format(what, ", ".join(known), ", ".join(found)))
    simulation.arrange(robots, doors, obstacles)


def _obstacle(name: str, item: Reader) -> ObstacleSpec:
    x, y, *size = item.numbers((3, 5), wanted="x, y and a radius, or x, y, width, depth and yaw")
    return ObstacleSpec(name, (x, y), box=Box(*size)) if len(size) > 1 else ObstacleSpec(name, (x, y), size[0])


def _two_poses(item: Reader) -> Tuple[Pose2D, Pose2D]:
    numbers = item.numbers((6,), wanted="x, y, yaw of the robot, and x, y, yaw of its odometry")
    return Pose2D(*numbers[:3]), Pose2D(*numbers[3:])
