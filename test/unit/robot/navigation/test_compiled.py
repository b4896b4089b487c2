"""The compiled loops, compared with brute force."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from occupied_grids import GRIDS, clearance_of, distance

from rosoclingo.robot.navigation.compiled.clearance import (
    inflate,
    square_distance,
)


@given(GRIDS, st.floats(1.0, 30.0))
def test_compiled_clearance_is_distance_to_nearest_occupied_square(occupied, reach):
    clearance = clearance_of(occupied, reach)
    for row in range(occupied.shape[0]):
        for column in range(occupied.shape[1]):
            if occupied[row, column]:
                assert clearance[row, column] == -0.5
            else:
                expected = min(reach, distance(occupied, column + 0.5, row + 0.5))
                assert abs(clearance[row, column] - expected) < 1e-4


@given(GRIDS, st.floats(0.0, 20.0), st.floats(0.0, 20.0), st.floats(0.5, 4.0))
def test_compiled_distance_of_a_point_from_occupied_cells(occupied, x, y, reach):
    assert abs(square_distance(occupied, x, y, reach) - min(reach, distance(occupied, x, y))) < 1e-9


@given(GRIDS, st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.7, -2.2]))
def test_compiled_costs_are_those_of_costmap_2d(occupied, seed, yaw):
    """Compared with their definition cell by cell, also rotated and beyond the grid."""
    random, clearance = np.random.default_rng(seed), clearance_of(occupied, 8.0)
    closed = random.random(occupied.shape) < 0.2
    x, y = random.uniform(-3.0, 8.0, 2)
    out = np.empty((9, 12), dtype=np.int8)
    inflate(clearance, occupied, closed, x, y, yaw, 1.5, 5.0, 0.8, out)
    for (i, j), cost in np.ndenumerate(out):
        column = math.floor(x + math.cos(yaw) * j - math.sin(yaw) * i + 1e-6)
        row = math.floor(y + math.sin(yaw) * j + math.cos(yaw) * i + 1e-6)
        if not (0 <= row < occupied.shape[0] and 0 <= column < occupied.shape[1]):
            assert cost == -1
        elif occupied[row, column]:
            assert cost == 100
        elif closed[row, column]:
            assert cost == -1
        elif clearance[row, column] < 1.5:
            assert cost == 99
        elif clearance[row, column] > 5.0:
            assert cost == 0
        else:
            assert cost == max(1, math.floor(98.0 * math.exp(-0.8 * (float(clearance[row, column]) - 1.5))))
