"""The compiled loops against brute force."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from occupied_grids import GRIDS, clearance_of, distance

from rosoclingo.navigation.compiled import (
    cast_rays,
    count_rays,
    hits_apart,
    inflate,
    square_distance,
    update_clearance,
)
from rosoclingo.simulation.compiled_shapes import CLEAR, body_hits, shorten_rays

NOTHING = np.empty((0, 4)), np.empty((0, 3)), np.empty((0, 2))


@given(GRIDS, st.floats(1.0, 30.0))
@settings(max_examples=60, deadline=None)
def test_clearance_is_the_distance_to_the_nearest_occupied_square(occupied, reach):
    clearance = clearance_of(occupied, reach)
    for row in range(occupied.shape[0]):
        for column in range(occupied.shape[1]):
            if occupied[row, column]:
                assert clearance[row, column] == -0.5
            else:
                expected = min(reach, distance(occupied, column + 0.5, row + 0.5))
                assert abs(clearance[row, column] - expected) < 1e-4


@given(GRIDS, st.data())
@settings(max_examples=60, deadline=None)
def test_a_window_brings_clearance_up_to_date(occupied, data):
    reach = 4.0
    clearance = clearance_of(occupied, reach)
    row = data.draw(st.integers(0, occupied.shape[0] - 1))
    column = data.draw(st.integers(0, occupied.shape[1] - 1))
    occupied[row, column] ^= 1
    low_r, high_r = max(0, row - 5), min(occupied.shape[0], row + 6)
    low_c, high_c = max(0, column - 5), min(occupied.shape[1], column + 6)
    update_clearance(occupied, reach, low_r, high_r, low_c, high_c, clearance)
    assert np.array_equal(clearance, clearance_of(occupied, reach))


@given(GRIDS, st.floats(-3.0, 23.0), st.floats(-3.0, 23.0), st.floats(-7.0, 7.0), st.floats(0.5, 40.0))
@settings(max_examples=150, deadline=None)
def test_rays_end_where_small_steps_meet_something(occupied, x, y, angle, reach):
    out = np.empty(1)
    cast_rays(occupied, x, y, np.array([angle]), reach, out)
    assert 0.0 <= out[0] <= reach
    places = np.arange(0.0, reach, 0.003)
    columns = np.floor(x + places * math.cos(angle)).astype(int)
    rows = np.floor(y + places * math.sin(angle)).astype(int)
    inside = (rows >= 0) & (rows < occupied.shape[0]) & (columns >= 0) & (columns < occupied.shape[1])
    hit = np.zeros(len(places), dtype=bool)
    hit[inside] = occupied[rows[inside], columns[inside]] > 0
    first = places[hit.argmax()] if hit.any() else reach
    # Small steps may leap over a corner that the ray cuts by less than a step.
    assert out[0] <= first + 1e-6
    end_x, end_y = x + (out[0] + 1e-6) * math.cos(angle), y + (out[0] + 1e-6) * math.sin(angle)
    assert abs(out[0] - first) < 0.005 or distance(occupied, end_x, end_y) < 1e-4


@given(
    st.lists(st.tuples(*[st.integers(-9, 9)] * 4), max_size=4),
    st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9), st.floats(0.1, 3)), max_size=3),
    st.floats(-3.2, 3.2),
)
@settings(max_examples=100, deadline=None)
def test_rays_end_at_doors_and_discs(segments, discs, angle):
    out = np.array([12.0])
    shorten_rays(
        0.0, 0.0, np.array([angle]), np.array(segments, dtype=float).reshape(-1, 4), np.array(discs).reshape(-1, 3), out
    )
    dx, dy = math.cos(angle), math.sin(angle)
    best = 12.0
    for x, y, radius in discs:
        roots = np.roots([1.0, -2.0 * (x * dx + y * dy), x * x + y * y - radius * radius])
        assume(abs(abs(x * dy - y * dx) - radius) > 1e-3)  # whether a ray hits what it touches is a matter of rounding
        real = [root.real for root in roots if abs(root.imag) < 1e-9 and root.real > 0]
        if math.hypot(x, y) <= radius:
            best = 0.0
        elif real:
            best = min(best, *real)
    for x0, y0, x1, y1 in segments:
        matrix = np.array([[dx, x0 - x1], [dy, y0 - y1]])
        if abs(np.linalg.det(matrix)) > 1e-6:
            t, u = np.linalg.solve(matrix, [x0, y0])
            assume(min(abs(t), abs(u), abs(1.0 - u)) > 1e-6)  # the same of one that begins or ends where a door does
            if t >= 0 and 0 <= u <= 1:
                best = min(best, t)
    assert abs(out[0] - best) < 1e-3


@given(GRIDS, st.floats(0.0, 20.0), st.floats(0.0, 20.0), st.floats(0.2, 4.0))
@settings(max_examples=100, deadline=None)
def test_a_disc_hits_what_is_nearer_than_its_radius(occupied, x, y, radius):
    away = distance(occupied, x, y)
    if abs(away - radius) > 1e-9:
        assert (body_hits(occupied, *NOTHING, radius, x, y, 0.0) != CLEAR) == (away < radius)


class Counted:
    """Counts and marks of rows of cells that one ray at a time looks along, ``spacing`` rad from the next."""

    def __init__(self, spacing=0.0):
        self.counts, self.marks, self.mapped = (np.zeros((5, 9), dtype=np.uint8) for _ in range(3))
        self.spots, self.spacing = np.zeros((5, 9, 2), dtype=np.uint8), spacing

    def ray(self, length, hit=True, times=1, y=2.5):
        for _ in range(times):
            window = count_rays(
                self.counts,
                self.marks,
                self.spots,
                self.mapped,
                0.5,
                y,
                np.zeros(1),
                np.array([length]),
                np.array([hit]),
                0.2,
                self.spacing,
                2,
                24,
                8,
            )
        return window


def test_a_cell_is_marked_once_it_is_sure_and_cleared_once_rays_pass():
    row = Counted()
    assert row.ray(5.2, times=3) == (0, 0, 0, 0)
    assert row.ray(5.2) == (2, 3, 5, 6)
    assert np.argwhere(row.marks).tolist() == [[2, 5]]
    assert row.ray(5.2, times=20) == (0, 0, 0, 0)
    assert row.ray(7.0, hit=False, times=23) == (0, 0, 0, 0)
    assert row.ray(7.0, hit=False) == (2, 3, 5, 6)
    assert not row.marks.any()


def test_rare_hits_are_noise_and_rare_passes_clear_nothing():
    row = Counted()
    for _ in range(50):
        row.ray(5.2)
        row.ray(7.0, hit=False, times=3)
    assert not row.marks.any()
    row.ray(5.2, times=12)
    for _ in range(50):
        row.ray(5.2, times=2)
        row.ray(7.0, hit=False, times=3)
    assert row.marks.sum() == 1


def test_what_fills_a_part_of_a_cell_is_not_cleared_by_what_passes_beside_it():
    row = Counted()
    row.ray(5.2, times=12, y=2.1)
    row.ray(7.0, hit=False, times=100, y=2.4)
    assert row.marks.sum() == 1
    row.ray(7.0, hit=False, times=24, y=2.25)
    assert not row.marks.any()


def test_where_rays_are_far_apart_one_that_passes_by_will_do():
    row = Counted(spacing=0.2)  # some 0.9 cells there
    row.ray(5.2, times=12, y=2.1)
    row.ray(7.0, hit=False, times=24, y=2.7)
    assert row.marks.sum() == 1
    row.ray(7.0, hit=False, times=24, y=2.5)
    assert not row.marks.any()


def test_the_place_of_what_is_hit_follows_the_hits():
    row = Counted()
    row.ray(5.2, times=12, y=2.1)
    row.ray(5.2, times=40, y=2.8)
    row.ray(7.0, hit=False, times=24, y=2.1)
    assert row.marks.sum() == 1
    row.ray(7.0, hit=False, times=24, y=2.8)
    assert not row.marks.any()


def test_hits_on_the_map_are_left_out():
    row = Counted()
    row.mapped[2, 5] = 1
    row.ray(5.2, times=20)
    assert not row.marks.any()


@given(GRIDS, st.floats(0.0, 20.0), st.floats(0.0, 20.0), st.floats(0.5, 4.0))
@settings(max_examples=100, deadline=None)
def test_the_distance_of_a_point_from_what_is_occupied(occupied, x, y, reach):
    assert abs(square_distance(occupied, x, y, reach) - min(reach, distance(occupied, x, y))) < 1e-9


@given(GRIDS, st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_hits_apart_are_those_near_and_away_from_what_is_known(occupied, seed):
    """Against the same by numpy, with rays that leave the grid too."""
    random, clearance = np.random.default_rng(seed), clearance_of(occupied, 8.0)
    x, y = random.uniform(0.0, occupied.shape[::-1])
    angles, ranges, hits = random.uniform(-4, 4, 60), random.uniform(0, 20, 60), random.random(60) < 0.8
    found = hits_apart(clearance, x, y, angles, ranges, hits, 9.0, 1.5)
    points = np.stack([x + ranges * np.cos(angles), y + ranges * np.sin(angles)], axis=1)[hits & (ranges < 9.0)]
    points = points[((points >= 0.0) & (points < occupied.shape[::-1])).all(axis=1)]
    column, row = points.astype(int).T
    assert found == pytest.approx(points[clearance[row, column] > 1.5])


@given(GRIDS, st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.7, -2.2]))
@settings(max_examples=50, deadline=None)
def test_costs_are_those_of_costmap_2d(occupied, seed, yaw):
    """Against their definition cell by cell, turned and beyond the grid too."""
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
