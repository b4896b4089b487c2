"""The simulated world: collisions, doors, obstacles, resets, determinism; other files cover the rest."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from navigation_worlds import room, simulation

from rosoclingo.robot.navigation import Pose2D
from rosoclingo.robot.simulation import Box, DoorSpec, ObstacleSpec, WorldError

COMMANDS = st.lists(st.tuples(st.floats(-2.0, 2.0), st.floats(-4.0, 4.0)), min_size=1, max_size=40)
STRONG = {"max_speed": 5.0, "max_turn": 9.0, "acceleration": 1e6, "turn_acceleration": 1e6}


def drive(world, commands):
    robot = world.robots["robot_0"]
    poses = []
    for v, w in commands:
        world.command("robot_0", v, w)
        world.step()
        poses.append(robot.pose)
    return poses


@given(COMMANDS)
@settings(max_examples=settings.default.max_examples // 3)
def test_simulation_is_deterministic_to_the_last_bit(commands):
    def run(scan):
        world = simulation(room(), Pose2D(1.0, 1.0), drift=(0.1, 0.1))
        poses = []
        for pose in drive(world, commands):
            poses.append((pose, world.robots["robot_0"].odometry, world.scan("robot_0").tobytes() if scan else b""))
        return poses

    assert run(True) == run(True)
    assert [p[:2] for p in run(True)] == [p[:2] for p in run(False)]


def test_simulation_collision_stops_robot_and_is_reported_once():
    world = simulation(room(3.0, 3.0), Pose2D(1.5, 1.5, 0.0), laser=None, **STRONG)
    collisions = []
    for _ in range(20):
        world.command("robot_0", 1.0, 0.0)
        collisions += world.step()
    robot = world.robots["robot_0"]
    assert len(collisions) == 1
    assert "wall" in collisions[0].what
    assert 0.0 <= 2.9 - 0.18 - robot.pose.x < 0.02
    assert robot.stalled
    drive(world, [(-1.0, 0.0)])
    assert robot.pose.x < 2.65


def test_simulation_refuses_unknown_or_impossible_changes():
    door = DoorSpec("door", (1.0, 0.5), (1.0, 1.5), open=True)
    world = simulation(room(), Pose2D(1.0, 1.0), doors=(door,), laser=None)
    for call, words in (
        (lambda: world.set_door("gate", True), "gate"),
        (lambda: world.set_door("door", False), "robot 'robot_0' would collide with a door"),
        (lambda: world.put_obstacle(ObstacleSpec("bin", (1.0, 1.0), radius=0.3)), "would collide"),
        (lambda: world.put_obstacle(ObstacleSpec("o", (math.nan, 1.0), 0.1)), "the obstacle 'o': .*finite"),
        (lambda: world.put_obstacle(ObstacleSpec("o", (3.0, 1.0), 0.1, Box(1.0, 1.0))), "either a positive radius"),
        (lambda: world.put_obstacle(ObstacleSpec("o", (3.0, 1.0), 0.0, Box(1.0, -1.0))), "must be positive"),
        (lambda: world.put_obstacle(ObstacleSpec("o", (3.0, 1.0), 0.0, Box(1.0, 1.0, math.nan))), "finite"),
        (lambda: world.put_obstacle(ObstacleSpec("o", (9.0, 1.0), 0.1)), r"\(9, 1\) is off the map, which covers x 0 "),
        (lambda: world.remove_obstacle("crate"), "crate"),
        (lambda: world.command("rover", 0.0, 0.0), "rover"),
        (lambda: world.scan("robot_0"), "no laser"),
        (lambda: world.place("robot_0", Pose2D(0.1, 0.1)), "wall"),
        (lambda: world.place("robot_0", Pose2D(99.0, 0.1)), "off the map"),
        (lambda: world.place("robot_0", Pose2D(math.nan, 0.1)), "finite"),
    ):
        with pytest.raises(WorldError, match=words):
            call()
    assert (world.doors["door"].open, world.obstacles) == (True, {})
    with pytest.raises(WorldError, match="wall"):
        simulation(room(), Pose2D(0.1, 1.0))


def test_simulation_reset_moves_all_robots_or_none():
    world = simulation(room(), Pose2D(1.0, 1.0), laser=None, drift=(0.1, 0.1))
    drive(world, [(0.5, 0.5)] * 10)
    robot = world.robots["robot_0"]
    world.place("robot_0", Pose2D(2.0, 2.0, 1.0))
    assert robot.odometry.distance(robot.pose) > 0.5
    world.put_obstacle(ObstacleSpec("crate", (1.0, 1.0), 0.2))
    with pytest.raises(WorldError, match="robot_0"):
        world.reset()
    assert robot.pose == Pose2D(2.0, 2.0, 1.0)
    world.remove_obstacle("crate")
    world.reset()
    assert robot.pose == robot.odometry == Pose2D(1.0, 1.0)
    assert (robot.v, robot.w) == (0.0, 0.0)
    assert world.time == pytest.approx(1.0)
