"""Where the grid planner's paths begin and end, and its reasons for impossible ones."""

import numpy as np
import pytest

from rosoclingo.robot.navigation import Costmap, CostmapLimits, GridPlanner, OccupancyGrid, PlanOutcome, Pose2D

START = Pose2D(0.95, 0.95, 0.0)


def floor():
    """A room of 4 m by 4 m, 0.1 m a cell, and at x = 3 m a dead-end corridor of 0.4 m that leads upwards."""
    cells = np.full((80, 40), 100, dtype=np.int8)
    cells[1:40, 1:39] = 0
    cells[40:70, 28:32] = 0
    return Costmap(OccupancyGrid(cells, 0.1), CostmapLimits(robot_radius=0.18))


@pytest.mark.slow
@pytest.mark.parametrize("x", [0.281, 0.299, 0.3, 0.45, 3.719])
def test_grid_planner_path_ends_exactly_at_free_goal(x):
    """The middle of the goal's cell need not be free."""
    goal = Pose2D(x, 2.02, 0.0)
    plan = GridPlanner().plan(floor(), START, goal)
    assert plan.outcome is PlanOutcome.FOUND
    assert tuple(plan.points[0]) == pytest.approx(START[:2])
    assert tuple(plan.points[-1]) == pytest.approx(goal[:2])


@pytest.mark.parametrize("goal", [Pose2D(0.2, 2.0, 0.0), Pose2D(3.9, 2.05, 0.0), Pose2D(2.85, 5.0, 0.0)])
def test_grid_planner_finds_no_path_to_occupied_goal(goal):
    assert GridPlanner().plan(floor(), START, goal).outcome is PlanOutcome.GOAL_IN_OBSTACLE


def test_grid_planner_path_ends_nearby_within_tolerance():
    plan = GridPlanner().plan(floor(), START, Pose2D(0.2, 2.0, 0.0), tolerance=0.2)
    assert plan.outcome is PlanOutcome.FOUND
    assert np.hypot(*(plan.points[-1] - (0.2, 2.0))) <= 0.2


@pytest.mark.parametrize("y", [4.5, 6.0, 6.7])
def test_grid_planner_enters_corridor_centred_between_two_cells(y):
    for ends in ((START, Pose2D(3.0, y, 0.0)), (Pose2D(3.0, y, 0.0), START)):
        plan = GridPlanner().plan(floor(), *ends)
        assert plan.outcome is PlanOutcome.FOUND
        assert tuple(plan.points[-1]) == pytest.approx(ends[1][:2])
        inside = plan.points[plan.points[:, 1] > 4.0]
        assert np.abs(inside[:, 0] - 3.0).max() < 0.025


@pytest.mark.parametrize(
    ("end", "outcome"), [(3.45, PlanOutcome.FOUND), (3.55, PlanOutcome.BLOCKED)], ids=["4 cells", "3 cells"]
)
def test_grid_planner_uses_narrow_gap_next_to_unmapped_obstacle(end, outcome):
    """Marks of the laser are treated like the map: a row of cells that ends before the wall."""
    costmap = floor()
    sensor = Pose2D(2.0, 0.5, np.pi / 2)
    angles = -np.arctan2(np.arange(0.15, end + 0.01, 0.02) - 2.0, 1.55)
    for _ in range(10):
        costmap.observe(sensor, angles, 1.55 / np.cos(angles), 6.0)
    free = 10 + np.flatnonzero(costmap.occupied[20, 10:] == 0)
    assert free.tolist() == list(range(round(end * 10 + 0.5), 39))
    assert GridPlanner().plan(costmap, START, Pose2D(1.0, 3.0, 0.0)).outcome is outcome
