"""Paths of the grid planner compared with shortest ones, from a search with many more directions, on random maps."""

import heapq
import math

import numpy as np
import pytest

from rosoclingo.robot.navigation import Costmap, CostmapLimits, GridPlanner, OccupancyGrid, PlanOutcome, Pose2D
from rosoclingo.robot.navigation.costmap import SPARE

RADIUS = 0.18
LEAST = RADIUS + SPARE  # clearance of a path
# Steps to all cells up to 4 away that are not collinear with a nearer one: 48 directions, at most 0.7 % too long.
DIRECTIONS = [(r, c) for r in range(-4, 5) for c in range(-4, 5) if math.gcd(r, c) == 1]


def clutter(seed, size=90):
    """Boxes, walls with gaps, single cells: a map with many detours, 0.1 m a cell."""
    random = np.random.default_rng(seed)
    cells = np.zeros((size, size), dtype=np.int8)
    cells[:1] = cells[-1:] = 100
    cells[:, :1] = cells[:, -1:] = 100
    for _ in range(18):
        row, column = random.integers(3, size - 12, 2)
        cells[row : row + random.integers(1, 11), column : column + random.integers(1, 11)] = 100
    for row, column in random.integers(2, size - 2, (25, 2)):
        cells[row, column] = 100
    wall = int(random.integers(25, 65))
    cells[wall] = 100
    for gap in random.integers(5, size - 12, 3):
        cells[wall, gap : gap + random.integers(5, 9)] = 0
    return OccupancyGrid(cells, 0.1)


def distances(grid):
    """The exact distance (cells) of each point of a raster of half cells from the nearest occupied cell."""
    rows, columns = np.nonzero(grid.cells)
    height, width = grid.shape
    away = np.full((2 * height + 1, 2 * width + 1), np.inf)
    y, x = np.indices(away.shape) / 2.0
    for row, column in zip(rows, columns):
        low_r, high_r = max(0, 2 * row - 6), 2 * row + 9
        low_c, high_c = max(0, 2 * column - 6), 2 * column + 9
        part = (slice(low_r, high_r), slice(low_c, high_c))
        dx = np.maximum(np.maximum(column - x[part], x[part] - column - 1), 0)
        dy = np.maximum(np.maximum(row - y[part], y[part] - row - 1), 0)
        away[part] = np.minimum(away[part], np.hypot(dx, dy))
    return away


def shortest(grid, start, goal):
    """Return the length (m) of the shortest path between two cells' middles with clearance LEAST, or infinity.

    It leads over a raster of half cells, so that one of its points is in the narrowest part of each free gap.
    """
    good = distances(grid) >= LEAST / grid.resolution
    first, last = ((2 * row + 1, 2 * column + 1) for row, column in (start, goal))
    best, heap = {first: 0.0}, [(0.0, first)]
    while heap:
        length, here = heapq.heappop(heap)
        if here == last:
            return 0.5 * length * grid.resolution
        if length > best[here]:
            continue
        for direction in DIRECTIONS:
            there = here[0] + direction[0], here[1] + direction[1]
            inside = 0 <= there[0] < good.shape[0] and 0 <= there[1] < good.shape[1]
            if not inside or not good[there]:
                continue
            new = length + math.hypot(*direction)
            if new < best.get(there, math.inf) and line_is_good(good, here, direction):
                best[there] = new
                heapq.heappush(heap, (new, there))
    return math.inf


def line_is_good(good, here, direction):
    """Return whether the raster points along a line are good."""
    count = max(abs(direction[0]), abs(direction[1]))
    return all(
        good[round(here[0] + direction[0] * i / count), round(here[1] + direction[1] * i / count)]
        for i in range(count + 1)
    )


@pytest.mark.sampled(2)
@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_path_is_within_a_tenth_of_the_shortest(seed):
    """It has more clearance where possible, and half a cell less where necessary."""
    grid = clutter(seed)
    costmap = Costmap(grid, CostmapLimits(robot_radius=RADIUS))
    free = np.argwhere(costmap.clearance > 2.2)
    random = np.random.default_rng(seed)
    planner = GridPlanner()
    for _ in range(3):
        start, goal = (tuple(int(i) for i in free[random.integers(len(free))]) for _ in range(2))
        plan = planner.plan(costmap, Pose2D(*grid.centre(*start)), Pose2D(*grid.centre(*goal)))
        best = shortest(grid, start, goal)
        if plan.outcome is not PlanOutcome.FOUND:
            assert best == math.inf
        elif best > 3.0:
            assert plan.length <= 1.1 * best
            assert plan.length >= 0.97 * best  # otherwise it would cut corners, or the reference would be too long
