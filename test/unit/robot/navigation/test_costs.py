"""Costs of cells, as the topics of a costmap publish them."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from occupied_grids import GRIDS

from rosoclingo.robot.navigation import Costmap, CostmapLimits, OccupancyGrid, Pose2D

LIMITS = CostmapLimits(robot_radius=1.5, inflation_radius=5.0, cost_scaling_factor=0.8)


@given(GRIDS, st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.7, -2.2]))
def test_costs_are_those_of_costmap_2d(occupied, seed, yaw):
    """Compared with their definition cell by cell, also rotated and beyond the grid."""
    random = np.random.default_rng(seed)
    closed = (random.random(occupied.shape) < 0.2) & (occupied == 0)
    costmap = Costmap(OccupancyGrid((occupied * 100 - 1 * closed).astype(np.int8), 1.0), LIMITS)
    x, y = random.uniform(-3.0, 8.0, 2)
    for (i, j), cost in np.ndenumerate(costmap.costs_around(Pose2D(x, y, yaw), (9, 12))):
        column = math.floor(x + math.cos(yaw) * j - math.sin(yaw) * i + 1e-6)
        row = math.floor(y + math.sin(yaw) * j + math.cos(yaw) * i + 1e-6)
        if not (0 <= row < occupied.shape[0] and 0 <= column < occupied.shape[1]):
            assert cost == -1
        elif occupied[row, column]:
            assert cost == 100
        elif closed[row, column]:
            assert cost == -1
        elif costmap.clearance[row, column] < 1.5:
            assert cost == 99
        elif costmap.clearance[row, column] > 5.0:
            assert cost == 0
        else:
            assert cost == max(1, math.floor(98.0 * math.exp(-0.8 * (float(costmap.clearance[row, column]) - 1.5))))
