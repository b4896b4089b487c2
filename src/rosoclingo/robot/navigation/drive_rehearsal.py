"""A rehearsal of everything that is compiled for navigation: afterwards a drive has nothing left to compile."""

import numpy as np

from rosoclingo.robot.navigation.body import Body
from rosoclingo.robot.navigation.costmap import Costmap, CostmapLimits
from rosoclingo.robot.navigation.follower import RolloutFollower
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import OccupancyGrid
from rosoclingo.robot.navigation.grid_planner import GridPlanner
from rosoclingo.robot.navigation.inflated_ways import InflatedWays
from rosoclingo.robot.navigation.local_planner import Velocity, way_radii
from rosoclingo.robot.navigation.navigator import Navigator
from rosoclingo.robot.navigation.squeeze import Squeeze
from rosoclingo.robot.navigation.way_out import WayOut

__all__ = ["rehearse"]

START, GOAL = Pose2D(1.0, 1.5, 0.0), Pose2D(3.0, 1.5, 1.0)
FOOTPRINT = ((0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.3, -0.2))
RADIUS = 0.2


def rehearse() -> None:
    """Plan, mark, follow, squeeze through and get out on a small map of its own, with what a robot would hand over.

    It does not matter what comes of it, only that each function has been called with each kind of argument.
    """
    costmap = _costmap()
    _plan(costmap)
    _mark(costmap)
    _drive(costmap)


def _costmap() -> Costmap:
    """Two halves of a room of 4 m by 3 m with a way between them."""
    cells = np.zeros((60, 80), dtype=np.int8)
    cells[:2] = cells[-2:] = cells[:, :2] = cells[:, -2:] = 100
    cells[20:45, 39:41] = 100
    limits = CostmapLimits(robot_radius=RADIUS, way_radii=way_radii(RADIUS, FOOTPRINT))
    return Costmap(OccupancyGrid(cells, 0.05), limits)


def _plan(costmap: Costmap) -> None:
    planner = GridPlanner()
    while planner.prepare(costmap):
        pass
    planner.plan(costmap, START, GOAL)
    planner.plan(costmap, START, Pose2D(0.15, 0.15))  # next to the wall: looks for the nearest place
    InflatedWays(costmap).lengths_to(GOAL, [START])
    navigator = Navigator(costmap, planner, RolloutFollower(radius=RADIUS), [])
    navigator.set_goal(0.0, GOAL)
    for time in (0.1, 0.2):
        navigator.tick(time, START, Velocity(), 0.1)


def _mark(costmap: Costmap) -> None:
    angles = np.linspace(-1.0, 1.0, 20)
    for distance in (0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 2.0):
        costmap.observe(START, angles, np.full(20, distance), 5.0)
    costmap.bar(2.0, 2.5)
    costmap.unbar()
    costmap.forget(START.x, START.y)
    costmap.costs()


def _drive(costmap: Costmap) -> None:
    points, still = np.array([START[:2], (2.0, 0.5), GOAL[:2]]), Velocity()
    for footprint in ((), FOOTPRINT):
        follower, body = RolloutFollower(radius=RADIUS, footprint=footprint), Body(RADIUS, footprint)
        follower.set_plan(points, GOAL)
        follower.compute(costmap, START, still, 0.1)
        follower.may_turn(costmap, START, 1.0)
        now = body.situation(costmap, START, still, 0.1)
        body.spare(now, 0.1)
        body.is_clear(now, Velocity(0.1, 0.1), 0.0)
        body.may_turn(now, 1.0)
        Squeeze(0.1, 1.0, 1.0).command(body, now, points[1:])
        WayOut(0.1).begin(body, now)
