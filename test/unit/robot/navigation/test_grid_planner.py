"""Where the grid planner's ways begin and end, and what it says of those that cannot be."""

import numpy as np
import pytest

from rosoclingo.robot.navigation import Costmap, CostmapLimits, GridPlanner, OccupancyGrid, PlanOutcome, Pose2D

START = Pose2D(0.95, 0.95, 0.0)


def floor():
    """A room of 4 m by 4 m, 0.1 m a cell, and at x = 3 m a corridor of 0.4 m that leads up out of it and ends."""
    cells = np.full((80, 40), 100, dtype=np.int8)
    cells[1:40, 1:39] = 0
    cells[40:70, 28:32] = 0
    return Costmap(OccupancyGrid(cells, 0.1), CostmapLimits(robot_radius=0.18))


@pytest.mark.slow
@pytest.mark.parametrize("x", [0.281, 0.299, 0.3, 0.45, 3.719])
def test_a_way_ends_at_the_very_goal_wherever_the_robot_can_stand(x):
    """Whether or not it could stand in the middle of the goal's cell."""
    goal = Pose2D(x, 2.02, 0.0)
    plan = GridPlanner().plan(floor(), START, goal)
    assert plan.outcome is PlanOutcome.FOUND
    assert tuple(plan.points[0]) == pytest.approx(START[:2])
    assert tuple(plan.points[-1]) == pytest.approx(goal[:2])


@pytest.mark.parametrize("goal", [Pose2D(0.2, 2.0, 0.0), Pose2D(3.9, 2.05, 0.0), Pose2D(2.85, 5.0, 0.0)])
def test_no_way_ends_where_the_robot_cannot_stand(goal):
    assert GridPlanner().plan(floor(), START, goal).outcome is PlanOutcome.GOAL_IN_OBSTACLE


def test_but_it_ends_nearby_where_that_is_tolerated():
    plan = GridPlanner().plan(floor(), START, Pose2D(0.2, 2.0, 0.0), tolerance=0.2)
    assert plan.outcome is PlanOutcome.FOUND
    assert np.hypot(*(plan.points[-1] - (0.2, 2.0))) <= 0.2


@pytest.mark.parametrize("y", [4.5, 6.0, 6.7])
def test_a_way_leads_into_a_corridor_whose_middle_lies_between_two_cells(y):
    for ends in ((START, Pose2D(3.0, y, 0.0)), (Pose2D(3.0, y, 0.0), START)):
        plan = GridPlanner().plan(floor(), *ends)
        assert plan.outcome is PlanOutcome.FOUND
        assert tuple(plan.points[-1]) == pytest.approx(ends[1][:2])
        inside = plan.points[plan.points[:, 1] > 4.0]
        assert np.abs(inside[:, 0] - 3.0).max() < 0.025


@pytest.mark.parametrize(
    ("end", "outcome"), [(3.45, PlanOutcome.FOUND), (3.55, PlanOutcome.BLOCKED)], ids=["4 cells", "3 cells"]
)
def test_a_narrow_gap_that_something_unmapped_leaves(end, outcome):
    """What the laser has marked is treated as what is on the map: a row of cells that ends before the wall."""
    costmap = floor()
    sensor = Pose2D(2.0, 0.5, np.pi / 2)
    angles = -np.arctan2(np.arange(0.15, end + 0.01, 0.02) - 2.0, 1.55)
    for _ in range(10):
        costmap.observe(sensor, angles, 1.55 / np.cos(angles), 6.0)
    free = 10 + np.flatnonzero(costmap.occupied[20, 10:] == 0)
    assert free.tolist() == list(range(round(end * 10 + 0.5), 39))
    assert GridPlanner().plan(costmap, START, Pose2D(1.0, 3.0, 0.0)).outcome is outcome
