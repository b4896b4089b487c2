"""The part of a world's state from which a new process continues after a kill."""

import math

import pytest
from navigation_worlds import room

from rosoclingo.common.reading import Reader
from rosoclingo.robot.navigation import Pose2D
from rosoclingo.robot.simulation import Box, DoorSpec, ObstacleSpec, RobotSpec, Simulation, WorldError, WorldSpec

ROOM = room(4.0, 4.0, 0.05)
WORLD = WorldSpec(
    ROOM,
    (RobotSpec("first", Pose2D(1.0, 1.0), drift=(0.2, 0.2)), RobotSpec("second", Pose2D(3.0, 3.0))),
    doors=(DoorSpec("door", (2.0, 0.5), (2.0, 1.5)),),
    obstacles=(ObstacleSpec("bin", (1.0, 3.0), radius=0.2),),
)


def lived_in():
    """A world after some events."""
    world = Simulation(WORLD)
    for _ in range(5):
        world.command("first", 0.5, 0.3)
        world.step()
    world.place("second", Pose2D(3.0, 1.0, math.pi))
    world.set_door("door", False)
    world.remove_obstacle("bin")
    world.put_obstacle(ObstacleSpec("box", (3.0, 3.0), box=Box(0.3, 0.2, 0.1)))
    world.put_obstacle(ObstacleSpec("can", (0.5, 3.0), radius=0.1))
    return world


def resumed(state, spec=WORLD):
    world = Simulation(spec)
    world.resume(Reader(state, "~kept"))
    return world


def test_world_state_restores_positions_at_rest():
    before = lived_in()
    assert before.robots["first"].v > 0.0
    assert before.robots["first"].odometry != before.robots["first"].pose, "odometry has drifted"
    after = resumed(before.state())
    for name, robot in before.robots.items():
        assert (after.robots[name].pose, after.robots[name].odometry) == (robot.pose, robot.odometry)
        assert (after.robots[name].v, after.robots[name].w) == (0.0, 0.0)
    assert (after.doors, after.obstacles) == (before.doors, before.obstacles)
    assert after.time == 0.0
    assert (after.scan("second") == before.scan("second")).all(), "the laser's surroundings are restored, too"


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"robots": {"first": [1.0, 1.0, 0.0, 1.0, 1.0, 0.0]}}, "the robots are first, second, not first"),
        ({"doors": {}}, "the doors are door, not "),
        ({"doors": {"door": 1}}, "doors.door: must be true or false"),
        ({"obstacles": {"bin": [1.0]}}, "obstacles.bin: must be x, y and a radius"),
        ({"obstacles": {"bin": [1.0, 1.0, 0.3]}}, "robot 'first' would collide with an obstacle"),
        ({"obstacles": {"bin": [9.0, 1.0, 0.3]}}, "the obstacle 'bin': "),
        ({"robots": {"first": [0.0] * 6, "second": [3.0, 3.0, 0.0] * 2}}, "robot 'first' would collide with a wall"),
        ({"robots": 3}, "robots: must be a mapping"),
    ],
)
def test_world_state_refuses_state_of_another_world(change, text):
    world = Simulation(WORLD)
    before = world.state()
    with pytest.raises(WorldError) as caught:
        world.resume(Reader({**before, **change}, "~kept"))
    assert text in str(caught.value)
    assert world.state() == before
