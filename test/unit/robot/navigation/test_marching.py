"""The planner's march over a map: free cells, path costs, and descent, compared with brute force."""

import math

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from occupied_grids import GRIDS, clearance_of, distance, open_cells
from scipy.ndimage import label

from rosoclingo.robot.navigation.compiled.clearance import update_clearance, update_open
from rosoclingo.robot.navigation.compiled.marching import descend, ease, march, thin

RADII = st.floats(0.3, 3.0)
GO_ON = np.zeros(1, dtype=bool)


@given(GRIDS, RADII)
def test_march_open_cell_has_a_clear_raster_point(occupied, radius):
    found = open_cells(occupied, radius)
    for (row, column), is_open in np.ndenumerate(found):
        points = [(column + i / 2, row + j / 2) for i in range(3) for j in range(3)]
        most = max(distance(occupied, *point) for point in points)
        if abs(most - radius) > 1e-4 and abs(distance(occupied, *points[4]) - radius) > 1e-4:
            assert is_open == (most >= radius)


@given(GRIDS, RADII, st.data())
def test_march_window_updates_clearance_and_open_cells(occupied, radius, data):
    reach = 4.0
    clearance, out = clearance_of(occupied, reach), open_cells(occupied, radius, reach)
    row = data.draw(st.integers(0, occupied.shape[0] - 1))
    column = data.draw(st.integers(0, occupied.shape[1] - 1))
    occupied[row, column] ^= 1

    def window(span):
        rows = max(0, row - span), min(occupied.shape[0], row + span + 1)
        return (*rows, max(0, column - span), min(occupied.shape[1], column + span + 1))

    update_clearance(occupied, reach, *window(5), clearance)
    assert np.array_equal(clearance, clearance_of(occupied, reach))
    closed = np.zeros(occupied.shape, dtype=bool)
    update_open(clearance, occupied, closed, radius, *window(math.ceil(radius) + 2), out)
    assert np.array_equal(out, open_cells(occupied, radius, reach))


def costs_on(occupied):
    return np.where(occupied, np.inf, 1.0).astype(np.float32)


@given(GRIDS, st.data())
def test_march_path_descends_wherever_cells_are_joined(occupied, data):
    """It leads through adjacent cells and both ends, and crosses occupied cells by at most half a cell."""
    free = np.argwhere(occupied == 0)
    assume(len(free) >= 2)
    start, goal = (tuple(map(int, free[data.draw(st.integers(0, len(free) - 1))])) for _ in range(2))
    parts, _ = label(occupied == 0)
    towards = data.draw(st.booleans())
    found = march(costs_on(occupied), *goal, *(start if towards else (-1, -1)), GO_ON)
    assert math.isfinite(found[start]) == (parts[start] == parts[goal])
    if not math.isfinite(found[start]):
        return
    way = descend(found, *map(float, start), *map(float, goal))
    assert tuple(way[0]) == start
    assert tuple(way[-1]) == goal
    assert np.hypot(*np.diff(way, axis=0).T).max(initial=0.0) < 1.5
    for row, column in way:
        assert found[math.floor(row + 0.5), math.floor(column + 0.5)] < np.inf


@given(st.integers(0, 2**32 - 1), st.floats(0.5, 5.0), st.floats(0.01, 0.5))
def test_march_simplified_path_stays_near_original(seed, spacing, tolerance):
    random = np.random.default_rng(seed)
    turns = np.cumsum(random.normal(0.0, 0.4, 60))
    points = np.cumsum(0.5 * np.stack([np.cos(turns), np.sin(turns)], axis=1), axis=0)
    left = thin(points, spacing, tolerance)
    assert np.array_equal(left[[0, -1]], points[[0, -1]])
    assert np.hypot(*np.diff(left, axis=0).T).max() <= max(spacing, 0.5) + 1e-9
    indices = [int(np.flatnonzero((points == one).all(axis=1))[0]) for one in left]
    for first, last in zip(indices, indices[1:]):
        (ax, ay), (bx, by) = points[first], points[last]
        for x, y in points[first + 1 : last]:
            assert abs((x - ax) * (by - ay) - (y - ay) * (bx - ax)) <= tolerance * math.hypot(bx - ax, by - ay) + 1e-9


@given(GRIDS, st.integers(0, 2**32 - 1), st.floats(0.5, 3.0))
def test_march_moves_points_away_by_half_a_cell(occupied, seed, enough):
    points = np.random.default_rng(seed).uniform(0.0, 20.0, (12, 2))
    moved = points.copy()
    ease(moved, occupied, enough)
    assert np.array_equal(moved[[0, -1]], points[[0, -1]])
    assert np.hypot(*(moved - points).T).max() <= 0.5 + 1e-9
    for before, after in zip(points, moved):
        assert min(enough, distance(occupied, *after)) >= min(enough, distance(occupied, *before)) - 1e-9
