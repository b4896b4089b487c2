"""Random maps: reachable goals are found and unreachable ones reported, checked on a much finer lattice."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from occupied_grids import distance
from scipy.ndimage import label

from rosoclingo.robot.navigation import Costmap, CostmapLimits, GridPlanner, OccupancyGrid, PlanOutcome, Pose2D

CELL = 0.1  # m
FINE = 10  # points of the lattice per cell
STEP = CELL / FINE
# A path along the lattice is at most half a diagonal step closer to obstacles than its points.
SLACK = STEP * math.sqrt(0.5)
SPARE = 0.025  # m, on either side: a passage with less margin can count as closed
LACK = 0.5 * CELL  # m: a passage too narrow by this can count as open, and a path can come closer by this

maps = arrays(
    np.int8, st.tuples(st.integers(4, 18), st.integers(4, 18)), elements=st.sampled_from([0] * 9 + [100])
).map(lambda cells: np.pad(cells, 1, constant_values=100))
parts = st.floats(0.001, 0.999)


class Truth:
    """The distances (m) of a lattice's points from the nearest occupied cell."""

    def __init__(self, cells):
        self.shape = cells.shape
        height, width = (n * FINE + 1 for n in cells.shape)
        y, x = np.mgrid[0:height, 0:width] * STEP
        self.away = np.full((height, width), np.inf)
        for row, column in np.argwhere(cells == 100):
            dx = np.maximum(np.maximum(column * CELL - x, x - (column + 1) * CELL), 0.0)
            dy = np.maximum(np.maximum(row * CELL - y, y - (row + 1) * CELL), 0.0)
            self.away = np.minimum(self.away, np.hypot(dx, dy))

    def joined(self, clear, start, goal):
        """Return the target point, or any point of its cell, that a path with clearance ``clear`` (m) reaches."""
        parts, _ = label(self.away >= clear, structure=np.ones((3, 3)))
        there = (parts == parts[start]) & (parts > 0)
        row, column = (min(v // FINE, n - 1) * FINE for v, n in zip(goal, self.shape))
        return there[goal], there[row : row + FINE + 1, column : column + FINE + 1].any()


@pytest.mark.slow
@given(maps, st.floats(0.05, 0.25), st.tuples(parts, parts, parts))
def test_reachable_goals_are_found_and_others_reported(cells, radius, chosen):
    truth = Truth(cells)
    clear = np.argwhere(truth.away >= radius + SPARE)
    if not len(clear):
        return
    start = tuple(clear[int(chosen[0] * len(clear))])
    goal = tuple(int(part * n) for part, n in zip(chosen[1:], truth.away.shape))
    ends = [Pose2D(c * STEP, r * STEP) for r, c in (start, goal)]
    costmap = Costmap(OccupancyGrid(cells, CELL), CostmapLimits(robot_radius=radius))
    plan = GridPlanner().plan(costmap, *ends)
    if truth.joined(radius + SLACK + SPARE, start, goal)[0]:
        assert plan.outcome is PlanOutcome.FOUND
    # A goal too close to an obstacle counts as reached where the robot can stand in the goal's cell.
    if not truth.joined(max(0.0, radius - LACK) - SLACK, start, goal)[1]:
        assert plan.outcome.on_map
    if plan.outcome is PlanOutcome.FOUND:
        check_path(cells, radius, plan.points, ends, truth.away[goal] >= radius + SPARE)


def check_path(cells, radius, points, ends, exact):
    """Check that a path leads from start to goal, with the radius as clearance except for half a cell."""
    assert np.hypot(*(points[0] - ends[0][:2])) < 1e-6
    assert np.hypot(*(points[-1] - ends[1][:2])) < (1e-6 if exact else 1.5 * CELL)
    for a, b in zip(points[:-1], points[1:]):
        for t in np.linspace(0.0, 1.0, 2 + int(np.hypot(*(b - a)) / 0.01)):
            assert distance(cells == 100, *(a + (b - a) * t) / CELL) * CELL >= radius - LACK - 1e-6


def test_reachable_reports_a_goal_in_unknown_cells():
    cells = np.zeros((20, 20), dtype=np.int8)
    cells[10:] = -1
    grid, start, goal = OccupancyGrid(cells, CELL), Pose2D(0.5, 0.5), Pose2D(0.5, 1.5)
    plan = GridPlanner().plan(Costmap(grid), start, goal)
    assert plan.outcome is PlanOutcome.GOAL_UNKNOWN
    assert plan.outcome.on_map
    allowed = GridPlanner().plan(Costmap(grid, CostmapLimits(allow_unknown=True)), start, goal)
    assert allowed.outcome is PlanOutcome.FOUND
