"""The simulated world: exact kinematics, limits, collisions, doors, determinism."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from navigation_worlds import room, simulation

from rosoclingo.robot.navigation import Pose2D, normalize_angle
from rosoclingo.robot.simulation import (
    Box,
    DoorSpec,
    LaserSpec,
    ObstacleSpec,
    RobotSpec,
    Simulation,
    WorldError,
    WorldSpec,
)

COMMANDS = st.lists(st.tuples(st.floats(-2.0, 2.0), st.floats(-4.0, 4.0)), min_size=1, max_size=40)
STRONG = {"max_speed": 5.0, "max_turn": 9.0, "acceleration": 1e6, "turn_acceleration": 1e6}
SQUARE = ((0.2, 0.15), (-0.2, 0.15), (-0.2, -0.15), (0.2, -0.15))


def drive(world, commands):
    robot = world.robots["robot_0"]
    poses = []
    for v, w in commands:
        world.command("robot_0", v, w)
        world.step()
        poses.append(robot.pose)
    return poses


@given(st.floats(-2.0, 2.0), st.floats(-4.0, 4.0), st.integers(1, 20))
def test_a_constant_command_drives_the_exact_arc(v, w, steps):
    world = simulation(room(60.0, 60.0, 0.1), Pose2D(30.0, 30.0, 0.3), laser=None, **STRONG)
    pose = drive(world, [(v, w)] * steps)[-1]
    t = 0.1 * steps
    if abs(w) > 1e-8:
        x = 30.0 + v / w * (math.sin(0.3 + w * t) - math.sin(0.3))
        y = 30.0 - v / w * (math.cos(0.3 + w * t) - math.cos(0.3))
    else:
        x, y = 30.0 + v * t * math.cos(0.3), 30.0 + v * t * math.sin(0.3)
    assert math.hypot(pose.x - x, pose.y - y) < 1e-6
    assert abs(normalize_angle(pose.yaw - 0.3 - w * t)) < 1e-9


@given(COMMANDS, st.booleans())
def test_whatever_is_commanded_no_robot_is_ever_in_a_wall(commands, square):
    grid = room(2.0, 2.0, 0.05, walls=[(0.9, 0.9, 1.2, 1.1)])
    world = simulation(grid, Pose2D(0.5, 0.5), laser=None, footprint=SQUARE if square else (), radius=0.25, **STRONG)
    for pose in drive(world, commands):
        world.place("robot_0", pose)  # raises where the robot would stand in something


def test_who_drove_until_he_touched_a_wall_stands_free_of_it():
    """The wall ends at 0.1 m, the radius is 0.25 m."""
    world = simulation(room(2.0, 2.0, 0.05), Pose2D(0.5, 0.5), laser=None, radius=0.25, **STRONG)
    [pose] = drive(world, [(-2.0, 0.0)])
    assert pose == pytest.approx((0.35, 0.5, 0.0))
    world.place("robot_0", pose)
    with pytest.raises(WorldError, match="wall"):
        world.place("robot_0", pose._replace(x=pose.x - 1e-6))


@given(COMMANDS)
@settings(max_examples=settings.default.max_examples // 3)
def test_same_seed_and_commands_same_poses_to_the_last_bit(commands):
    def run(scan):
        world = simulation(room(), Pose2D(1.0, 1.0), drift=(0.1, 0.1))
        poses = []
        for pose in drive(world, commands):
            poses.append((pose, world.robots["robot_0"].odometry, world.scan("robot_0").tobytes() if scan else b""))
        return poses

    assert run(True) == run(True)
    assert [p[:2] for p in run(True)] == [p[:2] for p in run(False)]


def test_accelerations_and_speeds_are_limited():
    world = simulation(room(), Pose2D(1.0, 1.0), laser=None, max_speed=0.5, acceleration=1.0, max_turn=1.0)
    robot = world.robots["robot_0"]
    speeds = []
    for _ in range(8):
        world.command("robot_0", 9.0, 9.0)
        world.step()
        speeds.append(round(robot.v, 9))
    assert speeds == [0.1, 0.2, 0.3, 0.4, 0.5, 0.5, 0.5, 0.5]
    assert robot.w == 1.0


@pytest.mark.parametrize("command", [(math.nan, 0.0), (0.0, math.inf)])
def test_a_command_that_is_no_number_is_a_stop(command):
    world = simulation(room(), Pose2D(1.0, 1.0), laser=None, **STRONG)
    drive(world, [(1.0, 0.0), command])
    assert world.robots["robot_0"].v == 0.0


@pytest.mark.parametrize(
    ("watchdog", "speeds"),
    [(0.2, [0.5, 0.5, 0.0, 0.0]), (0.25, [0.5, 0.5, 0.5, 0.0]), (0.05, [0.5, 0.0, 0.0, 0.0]), (0.0, [0.5] * 4)],
)
def test_the_watchdog_stops_a_robot_that_nobody_commands(watchdog, speeds):
    """As in stage_ros: a command that old counts no more, and with 0 there is no watchdog."""
    world = simulation(room(), Pose2D(1.0, 1.0), laser=None, **STRONG)
    world.watchdog = watchdog
    for _ in range(2):
        world.command("robot_0", 0.5, 0.0)
        assert [(world.step(), world.robots["robot_0"].v)[1] for _ in speeds] == speeds


def test_a_collision_stops_the_robot_and_is_told_once():
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


def test_odometry_drifts_and_the_truth_does_not():
    exact = simulation(room(), Pose2D(1.0, 1.0), laser=None)
    drifting = simulation(room(), Pose2D(1.0, 1.0), laser=None, drift=(0.2, 0.2))
    commands = [(0.5, 0.2)] * 30
    assert drive(exact, commands) == drive(drifting, commands)
    robot = drifting.robots["robot_0"]
    assert exact.robots["robot_0"].odometry == exact.robots["robot_0"].pose
    assert 0.001 < robot.odometry.distance(robot.pose) < 0.5


def test_two_robots_stop_each_other_and_see_each_other():
    robots = (
        RobotSpec("a", Pose2D(1.0, 1.0, 0.0)),
        RobotSpec("b", Pose2D(3.0, 1.0, math.pi), footprint=SQUARE, radius=0.25),
    )
    world = Simulation(WorldSpec(room(), robots))
    assert abs(world.scan("a")[135] - (3.0 - 0.2 - 1.05)) < 0.02
    assert abs(world.scan("b")[135] - (3.0 - 0.05 - 1.18)) < 0.02
    collisions = []
    for _ in range(60):
        world.command("a", 0.5, 0.0)
        world.command("b", 0.5, 0.0)
        collisions += world.step()
    assert {c.robot for c in collisions} == {"a", "b"}
    gap = world.robots["b"].pose.x - world.robots["a"].pose.x
    assert 0.38 <= gap < 0.45


def test_doors_and_obstacles_block_robots_and_beams():
    grid = room(4.0, 2.0)
    door = DoorSpec("door", (2.0, 0.1), (2.0, 1.9), open=False)
    world = simulation(grid, Pose2D(1.0, 1.0, 0.0), doors=(door,), laser=LaserSpec(noise=0.0), **STRONG)
    ahead = 135
    assert abs(world.scan("robot_0")[ahead] - 0.95) < 0.01
    drive(world, [(1.0, 0.0)] * 15)
    assert world.robots["robot_0"].pose.x < 1.83
    world.set_door("door", True)
    assert world.scan("robot_0")[ahead] > 1.9
    drive(world, [(0.5, 0.0)] * 2)
    with pytest.raises(WorldError, match="robot"):
        world.set_door("door", False)
    assert world.doors["door"].open
    world.put_obstacle(ObstacleSpec("crate", (3.0, 1.0), box=Box(0.4, 0.4, 0.2)))
    assert world.scan("robot_0")[ahead] < 1.2
    with pytest.raises(WorldError, match="would stand"):
        world.put_obstacle(ObstacleSpec("bin", world.robots["robot_0"].pose[:2], radius=0.3))
    assert list(world.obstacles) == ["crate"]
    drive(world, [(1.0, 0.0)] * 15)
    assert world.robots["robot_0"].pose.x < 2.7
    world.remove_obstacle("crate")
    drive(world, [(1.0, 0.0)] * 3)
    assert world.robots["robot_0"].pose.x > 2.7


def test_what_is_unknown_or_impossible_is_refused():
    world = simulation(room(), Pose2D(1.0, 1.0), laser=None)
    for call, words in (
        (lambda: world.set_door("gate", True), "gate"),
        (lambda: world.remove_obstacle("crate"), "crate"),
        (lambda: world.command("rover", 0.0, 0.0), "rover"),
        (lambda: world.scan("robot_0"), "no laser"),
        (lambda: world.place("robot_0", Pose2D(0.1, 0.1)), "wall"),
        (lambda: world.place("robot_0", Pose2D(99.0, 0.1)), "off the map"),
        (lambda: world.place("robot_0", Pose2D(math.nan, 0.1)), "finite"),
    ):
        with pytest.raises(WorldError, match=words):
            call()
    with pytest.raises(WorldError, match="wall"):
        simulation(room(), Pose2D(0.1, 1.0))


def test_reset_puts_robots_back():
    world = simulation(room(), Pose2D(1.0, 1.0), laser=None, drift=(0.1, 0.1))
    drive(world, [(0.5, 0.5)] * 10)
    robot = world.robots["robot_0"]
    world.place("robot_0", Pose2D(2.0, 2.0, 1.0))
    assert robot.odometry.distance(robot.pose) > 0.5
    world.reset()
    assert robot.pose == robot.odometry == Pose2D(1.0, 1.0)
    assert (robot.v, robot.w) == (0.0, 0.0)
    assert world.time == pytest.approx(1.0)


def test_a_reset_that_is_impossible_moves_nobody():
    world = simulation(room(), Pose2D(1.0, 1.0), laser=None)
    world.place("robot_0", Pose2D(2.0, 2.0, 1.0))
    world.put_obstacle(ObstacleSpec("crate", (1.0, 1.0), 0.2))
    with pytest.raises(WorldError, match="robot_0"):
        world.reset()
    assert world.robots["robot_0"].pose == Pose2D(2.0, 2.0, 1.0)
    world.remove_obstacle("crate")
    world.reset()
    assert world.robots["robot_0"].pose == Pose2D(1.0, 1.0)


def test_the_laser_has_noise_a_fan_and_a_range():
    laser = LaserSpec(range=4.0, angle=180.0, beams=5, noise=0.05)
    world = simulation(room(20.0, 20.0, 0.1), Pose2D(1.0, 10.0, 0.0), laser=laser)
    scan = world.scan("robot_0")
    assert scan.dtype == np.float32
    assert scan.max() == 4.0
    assert world.robots["robot_0"].lasers[0].angles.tolist() == pytest.approx(
        [-math.pi / 2, -math.pi / 4, 0, math.pi / 4, math.pi / 2]
    )
    world.place("robot_0", Pose2D(1.0, 10.0, math.pi))
    ranges = [float(world.scan("robot_0")[2]) for _ in range(200)]
    assert np.mean(ranges) == pytest.approx(0.75, abs=0.02)
    assert np.std(ranges) == pytest.approx(0.05, abs=0.015)
