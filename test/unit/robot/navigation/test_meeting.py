"""What moves is in no costmap in time: robots brake for what the laser sees just now, and get past each other."""

import math
from pathlib import Path

import numpy as np
import pytest
from navigation_worlds import room

from rosoclingo.robot.navigation import (
    Costmap,
    GridPlanner,
    Navigator,
    Pose2D,
    RolloutFollower,
    Velocity,
    default_recoveries,
    load_map,
)
from rosoclingo.robot.navigation.brake import brake
from rosoclingo.robot.simulation import LaserSpec, RobotSpec, Simulation, WorldSpec

OFFICE = Path(__file__).resolve().parents[4] / "worlds" / "office.yaml"
HERE = Pose2D(0.0, 0.0)
SQUARE = ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2))


@pytest.mark.parametrize(
    ("velocity", "point", "expected"),
    [
        ((0.6, 0.0), (2.0, 0.0), (0.6, 0.0)),  # far ahead
        ((0.6, 0.0), (0.0, 0.5), (0.6, 0.0)),  # beside
        ((0.6, 0.0), (-0.4, 0.0), (0.6, 0.0)),  # behind
        ((0.6, 0.0), (0.7, 0.0), (0.36, 0.0)),  # slower is far enough
        ((0.6, 0.5), (0.3, 0.0), (0.0, 0.5)),  # it may turn
        ((-0.6, 0.0), (-0.3, 0.0), (0.0, 0.0)),
        ((0.6, 0.0), (-0.1, 0.0), (0.6, 0.0)),  # away from what is too near already
        ((0.0, 1.0), (0.1, 0.0), (0.0, 1.0)),
    ],
)
def test_braking_of_a_disc(velocity, point, expected):
    assert brake(Velocity(*velocity), HERE, np.array([point]), 0.2) == pytest.approx(expected)


def test_other_footprints_turn_only_where_no_corner_comes_near():
    assert brake(Velocity(0.6, 0.5), HERE, np.array([(0.3, 0.0)]), 0.2, SQUARE) == Velocity(0.0, 0.5)
    assert brake(Velocity(0.6, 0.5), HERE, np.array([(0.22, -0.15)]), 0.2, SQUARE) == Velocity()
    assert brake(Velocity(0.6, 0.5), HERE, np.empty((0, 2)), 0.2, SQUARE) == Velocity(0.6, 0.5)


BAR = ((0.4, 0.1), (-0.2, 0.1), (-0.2, -0.1), (0.4, -0.1))


@pytest.mark.parametrize(
    ("rate", "point", "stops"),
    [
        (1.0, (0.35, 0.15), True),  # a front corner is to pass there
        (-1.0, (0.35, 0.15), False),  # turns away from it
        (-1.0, (0.35, -0.15), True),
        (1.0, (0.0, 0.3), False),  # too far to the side for as long as is looked ahead
        (1.0, (0.35, 0.3), False),  # beyond the corner
        (1.0, (-0.17, -0.14), True),  # a rear corner
        (1.0, (0.3, 0.0), False),  # the robot is over it already
        (1.0, (0.35, 0.11), True),  # next to it
        (-1.0, (0.35, 0.11), False),
    ],
)
@pytest.mark.parametrize("yaw", [0.0, 2.0, -3.0])
def test_a_footprint_that_turns_on_the_spot_sweeps_over_nothing(rate, point, stops, yaw):
    pose = Pose2D(1.0, -2.0, yaw)
    at = np.array([pose.compose(Pose2D(*point))[:2]])
    assert brake(Velocity(0.0, rate), pose, at, 0.1, BAR) == (Velocity() if stops else Velocity(0.0, rate))


def test_a_footprint_that_backs_away_from_a_point_does_not_swing_a_corner_over_it():
    behind = np.array([(-0.17, -0.14)])
    assert brake(Velocity(-0.05, 1.0), HERE, behind, 0.1, BAR) == Velocity()
    ahead = np.array([(0.35, 0.15)])
    assert brake(Velocity(-0.1, 1.0), HERE, ahead, 0.1, BAR) == Velocity()
    assert brake(Velocity(-0.1, 0.0), HERE, ahead, 0.1, BAR) == Velocity(-0.1, 0.0)


def test_unmarked_is_what_neither_map_nor_marks_explain():
    costmap = Costmap(room())
    angles = np.array([-0.01, 0.0, 0.01, 0.5 * math.pi, math.pi])
    ranges = np.array([1.0, 1.0, 1.0, 4.0, 0.9])  # something ahead, far away, the wall (noise included)
    costmap.observe(Pose2D(1.0, 3.0), angles, ranges, 8.0)
    assert costmap.unmarked == pytest.approx(np.array([[2.0, 3.0]]))
    for _ in range(8):
        costmap.observe(Pose2D(1.0, 3.0), angles, ranges, 8.0)
    assert not len(costmap.unmarked)


class Late:
    """A navigator whose control comes every third step only, and reaches the robot two steps late."""

    def __init__(self, world, name, goal):
        self.world, self.robot, self.result = world, world.robots[name], None
        self.navigator = Navigator(Costmap(world.spec.grid), GridPlanner(), RolloutFollower(), default_recoveries())
        self.navigator.set_goal(0.0, goal)
        self._under_way = []

    def step(self, number):
        robot, laser, navigator = self.robot, self.robot.lasers[0], self.navigator
        while self._under_way and self._under_way[0][0] <= number:
            self.world.command(robot.spec.name, *self._under_way.pop(0)[1])
        if number % 3 or self.result:
            return
        ranges = self.world.scan(robot.spec.name).astype(float)
        if navigator.costmap.observe(robot.pose.compose(laser.spec.pose), laser.angles, ranges, laser.spec.range):
            navigator.obstacles_changed()
        tick = navigator.tick(self.world.time, robot.pose, Velocity(robot.v, robot.w), 0.1)
        self._under_way.append((number + 2, tick.velocity))
        self.result = tick.result


@pytest.mark.mostly_slow
@pytest.mark.parametrize(("left", "right"), [(0.0, 0.0), (0.1, -0.1), (-0.3, -0.2)])
def test_two_robots_pass_each_other_though_their_control_is_late(left, right):
    laser = LaserSpec(beams=135, noise=0.01)
    robots = (
        RobotSpec("anna", Pose2D(2.0, left), lasers=(laser,)),
        RobotSpec("bert", Pose2D(13.0, right, math.pi), lasers=(laser,)),
    )
    world = Simulation(WorldSpec(load_map(OFFICE), robots), watchdog=0.5)
    drivers = [Late(world, "anna", Pose2D(13.0, 0.0)), Late(world, "bert", Pose2D(2.0, 0.0, math.pi))]
    collisions = []
    for number in range(1200):
        for driver in drivers:
            driver.step(number)
        collisions += world.step()
    assert collisions == []
    assert [driver.result.message for driver in drivers] == ["Goal reached."] * 2
