"""Where the robot may stand, and the ways between these places, against brute force on a raster of half cells."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from occupied_grids import GRIDS, distance, ground_of

from rosoclingo.robot.navigation.compiled.places import (
    NOWHERE,
    OPEN,
    line_is_clear,
    nearest_place,
    place_of,
    places_of,
    update_places,
)
from rosoclingo.robot.navigation.compiled.search import find_cells
from rosoclingo.robot.navigation.compiled.straightening import pull, straighten, tighten
from rosoclingo.robot.navigation.landmarks import CostWeights, Landmarks

WEIGHTS = CostWeights(5.0, 0.3)
NONE = np.empty((0, 0), dtype=np.float32)
RADII = st.floats(0.3, 3.0)
STEPS = [(r, c) for r in (-1, 0, 1) for c in (-1, 0, 1) if r or c]


@given(GRIDS, RADII)
def test_each_place_is_clear_and_in_its_cell(occupied, radius):
    ground = ground_of(occupied, radius)
    for row, column in np.argwhere(ground.places):
        x, y = place_of(ground.places, row, column)
        assert column <= x <= column + 1
        assert row <= y <= row + 1
        assert distance(occupied, x, y) >= radius - 1e-6


@given(GRIDS, RADII, st.data())
def test_a_window_brings_places_up_to_date(occupied, radius, data):
    ground = ground_of(occupied, radius)
    row = data.draw(st.integers(0, occupied.shape[0] - 1))
    column = data.draw(st.integers(0, occupied.shape[1] - 1))
    occupied[row, column] ^= 1
    span = math.ceil(radius) + 4
    fresh = ground_of(occupied, radius)
    ground.clearance[:] = fresh.clearance
    rows, columns = (max(0, row - span), row + span + 1), (max(0, column - span), column + span + 1)
    update_places(ground, rows[0], min(rows[1], occupied.shape[0]), columns[0], min(columns[1], occupied.shape[1]))
    assert np.array_equal(ground.places, fresh.places)


def joined(occupied, radius, cell):
    """The points (y, x in half cells) to which a way of half steps leads from a cell's middle."""
    first = (2 * cell[0] + 1, 2 * cell[1] + 1)
    good = {}

    def is_good(y, x):
        if (y, x) not in good:
            inside = 0 <= y <= 2 * occupied.shape[0] and 0 <= x <= 2 * occupied.shape[1]
            good[y, x] = inside and distance(occupied, x / 2, y / 2) >= radius
        return good[y, x]

    def is_way(here, step):
        parts = np.arange(1, 9) / 8
        return all(
            distance(occupied, (here[1] + step[1] * t) / 2, (here[0] + step[0] * t) / 2) >= radius for t in parts
        )

    seen, todo = {first}, [first]
    while todo:
        here = todo.pop()
        for step in STEPS:
            there = (here[0] + step[0], here[1] + step[1])
            if there not in seen and is_good(*there) and is_way(here, step):
                seen.add(there)
                todo.append(there)
    return seen


def test_a_way_along_the_very_edge_of_the_map():
    occupied = np.zeros((10, 11), dtype=np.uint8)
    occupied[1, 4] = occupied[6, 3] = 1
    for turned in (occupied, occupied[::-1], occupied.T, occupied.T[::-1, ::-1]):
        ground = ground_of(np.ascontiguousarray(turned), 2.5)
        good = np.argwhere(ground.places == OPEN)
        ways = [
            len(find_cells(ground, *WEIGHTS, *good[0], *goal, 8, Landmarks(ground, WEIGHTS).costs)) for goal in good
        ]
        assert all(ways)


@given(GRIDS, RADII, st.data())
def test_a_way_is_found_if_there_is_one_and_keeps_clear(occupied, radius, data):
    """With and without landmarks, in eight directions and in sixteen, also where only points between cells are free."""
    ground = ground_of(occupied, radius)
    good = np.argwhere(ground.places == OPEN)
    assume(len(good) >= 2)
    start, goal = (tuple(good[data.draw(st.integers(0, len(good) - 1))]) for _ in range(2))
    landmarks, steps = Landmarks(ground, WEIGHTS), data.draw(st.sampled_from([8, 16]))
    for _ in range(data.draw(st.integers(0, 8)) if steps == 8 else 0):
        landmarks.go_on()
    cells = find_cells(ground, *WEIGHTS, *start, *goal, steps, landmarks.costs)
    if not len(cells):
        assert (2 * goal[0] + 1, 2 * goal[1] + 1) not in joined(occupied, radius + 0.1, start)
        return
    assert tuple(cells[0]) == start
    assert tuple(cells[-1]) == goal
    assert np.square(np.diff(cells, axis=0)).sum(axis=1).max(initial=0) in ((0, 1, 2) if steps == 8 else (0, 1, 2, 5))
    points = places_of(ground.places, cells)
    keeps_clear(occupied, points, radius)
    pull(points, ground, *WEIGHTS, 1)
    points = straighten(points, ground, *WEIGHTS)
    tighten(points, ground, *WEIGHTS, 4)
    assert tuple(points[0]) == (start[1] + 0.5, start[0] + 0.5)
    assert tuple(points[-1]) == (goal[1] + 0.5, goal[0] + 0.5)
    keeps_clear(occupied, points, radius)


def keeps_clear(occupied, points, radius):
    for a, b in zip(points[:-1], points[1:]):
        for t in np.linspace(0, 1, 25):
            assert distance(occupied, *(a + (b - a) * t)) >= radius - 0.01


@pytest.mark.parametrize(("steps", "most"), [(8, 1.083), (16, 1.028)])
def test_the_more_directions_the_shorter_the_way(steps, most):
    """On an empty grid, to all cells: the most that it is longer than the straight line."""
    ground = ground_of(np.zeros((41, 41), dtype=np.uint8), 1.0)
    over = []
    for goal in np.argwhere(ground.places == OPEN):
        ways = find_cells(ground, *WEIGHTS, 20, 20, *goal, steps, NONE)
        away = math.hypot(*(goal - 20))
        over.append(np.hypot(*np.diff(ways, axis=0).T).sum() / away if away else 1.0)
    assert most - 0.01 < max(over) < most


@pytest.mark.once
@pytest.mark.parametrize("thickness", [1, 2, 3, 4, 7])
@pytest.mark.parametrize("width", [4, 6])
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("steps", [8, 16])
def test_a_gap_is_passed_if_it_is_wide_enough_between_two_cells(thickness, width, turned, steps):
    occupied = np.zeros((30, 31), dtype=np.uint8)
    occupied[12 : 12 + thickness] = 1
    occupied[:, 20 : 20 + width] = 0
    occupied = np.ascontiguousarray(occupied.T) if turned else occupied
    ends = ((3, 5), (25, 25)) if not turned else ((5, 3), (25, 25))
    for radius, found in ((0.5 * width - 0.1, True), (0.5 * width + 0.02, False)):
        cells = find_cells(ground_of(occupied, radius), *WEIGHTS, *ends[0], *ends[1], steps, NONE)
        assert bool(len(cells)) == found


def test_few_cells_have_a_place_besides_their_middle():
    """Along walls none is needed: a search would be slowed by them."""
    occupied = np.zeros((60, 60), dtype=np.uint8)
    occupied[:1] = occupied[-1:] = occupied[:, :1] = occupied[:, -1:] = 1
    occupied[20:30, 20:40] = 1
    places = ground_of(occupied, 1.8).places
    assert set(np.unique(places)) == {NOWHERE, OPEN}


@given(GRIDS, st.tuples(*[st.floats(0.0, 20.0)] * 4), st.floats(0.2, 4.0))
def test_a_line_is_clear_if_each_of_its_points_is(occupied, ends, radius):
    x0, y0, x1, y1 = ends
    clear = line_is_clear(ground_of(occupied, radius, 50.0), x0, y0, x1, y1, radius)
    away = [distance(occupied, x0 + (x1 - x0) * t, y0 + (y1 - y0) * t) for t in np.linspace(0, 1, 400)]
    inside = all(0 <= x <= occupied.shape[1] and 0 <= y <= occupied.shape[0] for x, y in ((x0, y0), (x1, y1)))
    if not inside:
        assert not clear
    elif abs(min(away) - radius) > 0.05:
        assert clear == (min(away) > radius)


@pytest.mark.slow
@given(GRIDS, st.tuples(*[st.floats(0.0, 20.0)] * 4))
def test_a_line_is_not_clear_where_nobody_knows_what_is_there(unknown, ends):
    x0, y0, x1, y1 = (min(end, size - 0.01) for end, size in zip(ends, unknown.shape[::-1] * 2))
    clear = line_is_clear(ground_of(np.zeros_like(unknown), 1.0, 50.0, unknown), x0, y0, x1, y1, 1.0)
    depth = [-_depth(unknown, x0 + (x1 - x0) * t, y0 + (y1 - y0) * t) for t in np.linspace(0, 1, 400)]
    if min(depth) > 1e-6 or min(depth) < -0.1:  # a corner may be touched, and cut by less
        assert clear == (min(depth) > 0.0)


def _depth(unknown, x, y):
    """How deep a point is in unknown cells, below 0 outside."""
    known = distance(1 - unknown, x, y)
    return known if known > 0.0 else -distance(unknown, x, y) or -1e-9


def test_the_nearest_place():
    occupied = np.ones((9, 9), dtype=np.uint8)
    occupied[3:6, 5:8] = 0  # room for one disc, in the middle of (4, 6)
    ground = ground_of(occupied, 1.4)
    assert nearest_place(ground, 3.2, 4.5, 3.4, False) == (4, 6)
    assert nearest_place(ground, 3.2, 4.5, 3.2, False) == (-1, -1)
    assert nearest_place(ground, 6.1, 4.1, 0.0, False) == (4, 6)  # the point's own cell
    assert nearest_place(ground, 6.45, 4.55, 3.0, True) == (4, 6)
    assert nearest_place(ground, 6.1, 4.1, 3.0, True) == (-1, -1)  # no line from there is clear
    assert nearest_place(ground_of(occupied, 1.6), 6.5, 4.5, 9.0, False) == (-1, -1)


def test_landmarks_lead_to_ways_as_cheap_and_tell_that_there_is_none():
    """Whatever the laser has marked since; a pocket that few ways lead to is no landmark's place."""
    random = np.random.default_rng(5)
    occupied = np.zeros((60, 60), dtype=np.uint8)
    occupied[:, 30] = occupied[20, :12] = occupied[:20, 12] = 1  # two halves, and a room in one of them
    occupied[28:31, 30] = 0
    occupied[56, 56:] = occupied[56:, 56] = 1  # a pocket
    landmarks = Landmarks(ground_of(occupied, 1.1), WEIGHTS)
    while not landmarks.done:
        landmarks.go_on()
    assert len(landmarks.costs) >= 3
    marked = occupied.copy()
    marked[tuple(random.integers(2, 58, (2, 40)))] = 1
    ground = ground_of(marked, 1.1)
    good = np.argwhere(ground.places)
    for _ in range(100):
        ends = good[random.integers(len(good), size=2)]
        led = find_cells(ground, *WEIGHTS, *ends[0], *ends[1], 8, landmarks.costs)
        plain = find_cells(ground, *WEIGHTS, *ends[0], *ends[1], 8, NONE)
        assert (len(led) > 0) == (len(plain) > 0)
        if len(plain):
            assert cost_of(led, ground) <= 1.004 * cost_of(plain, ground) + 0.02


def cost_of(cells, ground):
    """What travel along cells costs by the planner's weights."""
    factors = 1.0 + WEIGHTS.weight * np.maximum(0.0, 1.0 - ground.clearance[tuple(cells.T)] / WEIGHTS.comfort)
    lengths = np.hypot(*np.diff(cells, axis=0).T)
    return float((lengths * 0.5 * (factors[1:] + factors[:-1])).sum())
