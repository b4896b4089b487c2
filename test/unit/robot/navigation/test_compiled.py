"""The compiled loops, compared with brute force."""

import math

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from occupied_grids import GRIDS, clearance_of, distance

from rosoclingo.robot.navigation.compiled.clearance import (
    inflate,
    square_distance,
    update_clearance,
)
from rosoclingo.robot.simulation.compiled.shapes import CLEAR, body_hits, cast_rays

NOTHING = np.empty((0, 4)), np.empty((0, 3))


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


@given(GRIDS, st.data())
def test_compiled_window_updates_the_clearance(occupied, data):
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
def test_compiled_rays_end_at_first_occupied_step(occupied, x, y, angle, reach):
    out = np.empty(1)
    cast_rays(occupied, *NOTHING, x, y, np.array([angle]), reach, out)
    assert 0.0 <= out[0] <= reach
    places = np.arange(0.0, reach, 0.003)
    columns = np.floor(x + places * math.cos(angle)).astype(int)
    rows = np.floor(y + places * math.sin(angle)).astype(int)
    inside = (rows >= 0) & (rows < occupied.shape[0]) & (columns >= 0) & (columns < occupied.shape[1])
    hit = np.zeros(len(places), dtype=bool)
    hit[inside] = occupied[rows[inside], columns[inside]] > 0
    first = places[hit.argmax()] if hit.any() else reach
    # Small steps can skip a corner that the ray cuts by less than a step.
    assert out[0] <= first + 1e-6
    end_x, end_y = x + (out[0] + 1e-6) * math.cos(angle), y + (out[0] + 1e-6) * math.sin(angle)
    assert abs(out[0] - first) < 0.005 or distance(occupied, end_x, end_y) < 1e-4


@given(
    st.lists(st.tuples(*[st.integers(-9, 9)] * 4), max_size=4),
    st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9), st.floats(0.1, 3)), max_size=3),
    st.floats(-3.2, 3.2),
)
def test_compiled_rays_end_at_doors_and_discs(segments, discs, angle):
    out = np.empty(1)
    things = np.array(segments, dtype=float).reshape(-1, 4), np.array(discs).reshape(-1, 3)
    cast_rays(np.zeros((1, 1), dtype=np.uint8), *things, 0.0, 0.0, np.array([angle]), 12.0, out)
    dx, dy = math.cos(angle), math.sin(angle)
    best = 12.0
    for x, y, radius in discs:
        roots = np.roots([1.0, -2.0 * (x * dx + y * dy), x * x + y * y - radius * radius])
        assume(abs(abs(x * dy - y * dx) - radius) > 1e-3)  # rounding decides about a ray that touches the disc
        real = [root.real for root in roots if abs(root.imag) < 1e-9 and root.real > 0]
        if math.hypot(x, y) <= radius:
            best = 0.0
        elif real:
            best = min(best, *real)
    for x0, y0, x1, y1 in segments:
        matrix = np.array([[dx, x0 - x1], [dy, y0 - y1]])
        slant = abs(dx * (y0 - y1) - dy * (x0 - x1))
        assume(slant == 0.0 or slant > 1e-6)  # the same applies to a ray that runs almost along a door
        if slant:
            t, u = np.linalg.solve(matrix, [x0, y0])
            assume(min(abs(t), abs(u), abs(1.0 - u)) > 1e-6)  # or a ray that ends at the door, or at its end
            if t >= 0 and 0 <= u <= 1:
                best = min(best, t)
    assert abs(out[0] - best) < 1e-3


@given(GRIDS, st.floats(0.0, 20.0), st.floats(0.0, 20.0), st.floats(0.2, 4.0))
def test_compiled_disc_hits_objects_within_its_radius(occupied, x, y, radius):
    away = distance(occupied, x, y)
    if abs(away - radius) > 1e-9:
        assert (body_hits(occupied, *NOTHING, np.empty((0, 2)), radius, x, y, 0.0) != CLEAR) == (away < radius)


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
