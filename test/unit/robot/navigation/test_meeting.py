"""Moving obstacles reach the costmap too late: robots brake by the present scan, and pass each other."""

import math
from pathlib import Path

import numpy as np
import pytest
from navigation_worlds import Drive, room

from rosoclingo.robot.navigation import Costmap, Pose2D, Velocity, load_map
from rosoclingo.robot.navigation.brake import brake
from rosoclingo.robot.simulation import LaserSpec, RobotSpec, Simulation, WorldSpec

OFFICE = Path(__file__).resolve().parents[4] / "worlds" / "office.yaml"
SQUARE = ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2))


BAR = ((0.4, 0.1), (-0.2, 0.1), (-0.2, -0.1), (0.4, -0.1))


@pytest.mark.parametrize(
    ("velocity", "point", "radius", "footprint", "expected"),
    [
        # a disc
        ((0.6, 0.0), (0.7, 0.0), 0.2, (), (0.36, 0.0)),  # slower is far enough
        ((0.6, 0.5), (0.3, 0.0), 0.2, (), (0.0, 0.5)),  # it is free to turn
        ((0.6, 0.0), (-0.1, 0.0), 0.2, (), (0.6, 0.0)),  # away from obstacles that are too near already
        # a footprint turns only with free corners
        ((0.6, 0.5), (0.3, 0.0), 0.2, SQUARE, (0.0, 0.5)),
        ((0.6, 0.5), (0.22, -0.15), 0.2, SQUARE, (0.0, 0.0)),
        ((-0.05, 1.0), (-0.17, -0.14), 0.1, BAR, (0.0, 0.0)),  # backing away swings a corner
        ((-0.1, 0.0), (0.35, 0.15), 0.1, BAR, (-0.1, 0.0)),
        ((0.0, 1.0), (0.35, 0.15), 0.1, BAR, (0.0, 0.0)),  # on the spot, a front corner would pass there
        ((0.0, -1.0), (0.35, 0.15), 0.1, BAR, (0.0, -1.0)),  # turns away from it
        ((0.0, 1.0), (-0.17, -0.14), 0.1, BAR, (0.0, 0.0)),  # a rear corner
        ((0.0, 1.0), (0.3, 0.0), 0.1, BAR, (0.0, 1.0)),  # the robot stands on it already
    ],
)
@pytest.mark.parametrize("pose", [Pose2D(0.0, 0.0), Pose2D(1.0, -2.0, 2.0)])
def test_meeting_brakes_for_points_of_the_scan(velocity, point, radius, footprint, expected, pose):
    points = np.array([pose.compose(Pose2D(*point))[:2]])
    assert brake(Velocity(*velocity), pose, points, radius, footprint) == pytest.approx(expected)


def test_meeting_unmarked_points_are_unexplained_by_map_and_marks():
    costmap = Costmap(room())
    angles = np.array([-0.01, 0.0, 0.01, 0.5 * math.pi, math.pi])
    ranges = np.array([1.0, 1.0, 1.0, 4.0, 0.9])  # a point ahead, a far one, the wall (noise included)
    costmap.observe(Pose2D(1.0, 3.0), angles, ranges, 8.0)
    assert costmap.unmarked == pytest.approx(np.array([[2.0, 3.0]]))
    for _ in range(8):
        costmap.observe(Pose2D(1.0, 3.0), angles, ranges, 8.0)
    assert not len(costmap.unmarked)


@pytest.mark.slow
def test_meeting_robots_pass_each_other_despite_late_control():
    laser = LaserSpec(beams=135, noise=0.01)
    robots = (
        RobotSpec("anna", Pose2D(2.0, 0.1), lasers=(laser,)),
        RobotSpec("bert", Pose2D(13.0, -0.1, math.pi), lasers=(laser,)),
    )
    world = Simulation(WorldSpec(load_map(OFFICE), robots), watchdog=0.5)
    goals, results = {"anna": Pose2D(13.0, 0.0), "bert": Pose2D(2.0, 0.0, math.pi)}, []
    drives = [Drive(world, control=3, scan=3, late=2, name=name) for name in goals]
    for drive, goal in zip(drives, goals.values()):
        drive.navigator.set_goal(0.0, goal)
    collisions = []
    while world.steps < 1200:
        results += filter(None, [drive.command() for drive in drives])
        collisions += world.step()
    assert collisions == []
    assert [result.message for result in results] == ["Goal reached."] * 2
