"""The compiled loops against brute force."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from rosoclingo.navigation.compiled import cast_rays, count_rays, hits_apart, square_distance, update_clearance
from rosoclingo.navigation.compiled_search import find_cells, nearest_clear_cell
from rosoclingo.navigation.compiled_straightening import line_is_clear, straighten, tighten
from rosoclingo.navigation.landmarks import Landmarks, Tariff
from rosoclingo.simulation.compiled_shapes import CLEAR, body_hits, shorten_rays

GRIDS = arrays(np.uint8, st.tuples(st.integers(3, 20), st.integers(3, 20)), elements=st.sampled_from([0, 0, 0, 0, 1]))
NOTHING = np.empty((0, 4)), np.empty((0, 3)), np.empty((0, 2))


def clearance_of(occupied, reach=50.0):
    out = np.full(occupied.shape, 7.0, dtype=np.float32)
    update_clearance(occupied, reach, 0, occupied.shape[0], 0, occupied.shape[1], out)
    return out


def distance(occupied, x, y):
    rows, columns = np.nonzero(occupied)
    if not len(rows):
        return math.inf
    dx = np.maximum(np.maximum(columns - x, x - columns - 1), 0)
    dy = np.maximum(np.maximum(rows - y, y - rows - 1), 0)
    return float(np.hypot(dx, dy).min())


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
    """Counts and marks of a row of cells that one ray looks along."""

    def __init__(self):
        self.counts, self.marks, self.mapped = (np.zeros((5, 9), dtype=np.uint8) for _ in range(3))

    def ray(self, length, hit=True, times=1):
        for _ in range(times):
            window = count_rays(
                self.counts,
                self.marks,
                self.mapped,
                0.5,
                2.5,
                np.zeros(1),
                np.array([length]),
                np.array([hit]),
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


def test_hits_on_the_map_are_left_out():
    row = Counted()
    row.mapped[2, 5] = 1
    row.ray(5.2, times=20)
    assert not row.marks.any()


@given(GRIDS, st.floats(0.3, 2.5), st.data())
@settings(max_examples=150, deadline=None)
def test_a_way_is_found_if_there_is_one_and_keeps_clear(occupied, radius, data):
    """Against a flood fill, with and without landmarks; the straightened way is as clear as the radius."""
    clearance = clearance_of(occupied, 8.0)
    least = math.sqrt(radius * radius + 0.5)
    good = np.argwhere(clearance >= least)
    if len(good) < 2:
        return
    start = good[data.draw(st.integers(0, len(good) - 1))]
    goal = good[data.draw(st.integers(0, len(good) - 1))]
    landmarks = Landmarks(clearance, Tariff(least, 5.0, 0.3))
    for _ in range(data.draw(st.integers(0, 8))):
        landmarks.go_on()
    cells = find_cells(clearance, least, 5.0, 0.3, *start, *goal, landmarks.costs)
    assert bool(len(cells)) == reachable(clearance >= least, tuple(start), tuple(goal))
    if not len(cells):
        return
    assert tuple(cells[0]) == tuple(start)
    assert tuple(cells[-1]) == tuple(goal)
    assert np.abs(np.diff(cells, axis=0)).max(initial=0) <= 1
    body = (clearance, occupied, radius, 5.0, 0.3)
    points = straighten(np.ascontiguousarray(cells[:, ::-1] + 0.5), *body)
    tighten(points, *body, 4)
    assert tuple(points[0]) == (start[1] + 0.5, start[0] + 0.5)
    assert tuple(points[-1]) == (goal[1] + 0.5, goal[0] + 0.5)
    for a, b in zip(points[:-1], points[1:]):
        for t in np.linspace(0, 1, 25):
            assert distance(occupied, *(a + (b - a) * t)) >= radius - 0.01


def reachable(free, start, goal):
    seen, todo = {start}, [start]
    while todo:
        r, c = todo.pop()
        for there in ((r + i, c + j) for i in (-1, 0, 1) for j in (-1, 0, 1)):
            inside = 0 <= there[0] < free.shape[0] and 0 <= there[1] < free.shape[1]
            if inside and free[there] and there not in seen:
                seen.add(there)
                todo.append(there)
    return goal in seen


@given(GRIDS, st.tuples(*[st.floats(0.0, 20.0)] * 4), st.floats(0.2, 4.0))
@settings(max_examples=150, deadline=None)
def test_a_line_is_clear_if_each_of_its_points_is(occupied, ends, radius):
    x0, y0, x1, y1 = ends
    clear = line_is_clear(clearance_of(occupied), occupied, x0, y0, x1, y1, radius)
    away = [distance(occupied, x0 + (x1 - x0) * t, y0 + (y1 - y0) * t) for t in np.linspace(0, 1, 400)]
    inside = all(0 <= x < occupied.shape[1] and 0 <= y < occupied.shape[0] for x, y in ((x0, y0), (x1, y1)))
    if not inside:
        assert not clear
    elif abs(min(away) - radius) > 0.05:
        assert clear == (min(away) > radius)


@given(GRIDS, st.floats(0.0, 20.0), st.floats(0.0, 20.0), st.floats(0.5, 4.0))
@settings(max_examples=100, deadline=None)
def test_the_distance_of_a_point_from_what_is_occupied(occupied, x, y, reach):
    assert abs(square_distance(occupied, x, y, reach) - min(reach, distance(occupied, x, y))) < 1e-9


def test_the_nearest_clear_cell():
    clearance = np.zeros((9, 9), dtype=np.float32)
    clearance[4, 7] = 3.0
    assert nearest_clear_cell(clearance, 2.0, 4, 4, 3.5) == (4, 7)
    assert nearest_clear_cell(clearance, 2.0, 4, 4, 2.5) == (-1, -1)
    assert nearest_clear_cell(clearance, 4.0, 4, 4, 9.0) == (-1, -1)


def test_landmarks_lead_to_ways_as_cheap_and_tell_that_there_is_none():
    """Whatever the laser has marked since; a pocket that few ways lead to is no landmark's place."""
    random = np.random.default_rng(5)
    occupied = np.zeros((60, 60), dtype=np.uint8)
    occupied[:, 30] = occupied[20, :12] = occupied[:20, 12] = 1  # two halves, and a room in one of them
    occupied[28:31, 30] = 0
    occupied[56, 56:] = occupied[56:, 56] = 1  # a pocket
    alone = clearance_of(occupied, 8.0)
    tariff = Tariff(1.3, 5.0, 0.3)
    landmarks = Landmarks(alone, tariff)
    while not landmarks.done:
        landmarks.go_on()
    assert landmarks.costs.shape[1] >= 3
    marked = occupied.copy()
    marked[tuple(random.integers(2, 58, (2, 40)))] = 1
    clearance = clearance_of(marked, 8.0)
    good = np.argwhere(clearance >= tariff.least)
    none = np.empty((clearance.size, 0), dtype=np.float32)
    for _ in range(100):
        ends = good[random.integers(len(good), size=2)]
        led = find_cells(clearance, *tariff, *ends[0], *ends[1], landmarks.costs)
        plain = find_cells(clearance, *tariff, *ends[0], *ends[1], none)
        assert len(led) > 0 or len(plain) == 0
        if len(plain):
            assert cost_of(led, clearance, tariff) <= 1.004 * cost_of(plain, clearance, tariff) + 0.02


def cost_of(cells, clearance, tariff):
    """What travel along cells costs by the planner's tariff."""
    prices = 1.0 + tariff.weight * np.maximum(0.0, 1.0 - clearance[tuple(cells.T)] / tariff.comfort)
    lengths = np.hypot(*np.diff(cells, axis=0).T)
    return float((lengths * 0.5 * (prices[1:] + prices[:-1])).sum())


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
