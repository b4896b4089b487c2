"""What may change in a simulated world, as plain values: with them another process goes on where one was killed."""

from typing import Any, Dict, List, Tuple

from rosoclingo.common.reading import Reader
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.simulation.simulation import Simulation
from rosoclingo.robot.simulation.spec import Box, ObstacleSpec, WorldError


def world_state(simulation: Simulation) -> Dict[str, Any]:
    """Return where all is now, in numbers, texts, lists and mappings: m and rad.

    ``robots`` have pose and odometry (x, y, yaw each), ``doors`` whether they are open, ``obstacles`` x, y and a
    radius, or x, y, width, depth and yaw. Time and velocities are no part of it.
    """
    return {
        "robots": {name: [*map(float, robot.pose + robot.odometry)] for name, robot in simulation.robots.items()},
        "doors": {name: door.open for name, door in simulation.doors.items()},
        "obstacles": {name: _numbers(obstacle) for name, obstacle in simulation.obstacles.items()},
    }


def resume_world(simulation: Simulation, kept: Reader) -> None:
    """Put a world that has just begun into a state, robots at rest.

    Raises WorldError where that is none of this world; then the simulation is of no more use.
    """
    robots = {name: _two_poses(item) for name, item in kept.at("robots").entries()}
    doors = {name: item.flag() for name, item in kept.at("doors").entries()}
    obstacles = {name: _obstacle(name, item) for name, item in kept.at("obstacles").entries()}
    kept.check(WorldError)
    for known, found, what in ((simulation.robots, robots, "robots"), (simulation.doors, doors, "doors")):
        if known.keys() != found.keys():
            raise WorldError("its {} are {}, not {}".format(what, ", ".join(known), ", ".join(found)))
    simulation.arrange(robots, doors, obstacles)


def _numbers(obstacle: ObstacleSpec) -> List[float]:
    return [*map(float, obstacle.at + (obstacle.box or (obstacle.radius,)))]


def _obstacle(name: str, item: Reader) -> ObstacleSpec:
    x, y, *size = item.numbers((3, 5), wanted="x, y and a radius, or x, y, width, depth and yaw")
    return ObstacleSpec(name, (x, y), box=Box(*size)) if len(size) > 1 else ObstacleSpec(name, (x, y), size[0])


def _two_poses(item: Reader) -> Tuple[Pose2D, Pose2D]:
    numbers = item.numbers((6,), wanted="x, y, yaw of the robot, and as odometry has them")
    return Pose2D(*numbers[:3]), Pose2D(*numbers[3:])
