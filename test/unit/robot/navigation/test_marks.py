"""How scans mark and clear cells of a costmap."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from navigation_worlds import room
from occupied_grids import GRIDS, clearance_of, distance

from rosoclingo.robot.navigation import Costmap, CostmapLimits, Pose2D
from rosoclingo.robot.navigation.compiled.marks import count_scan, hits_apart


class Row:
    """Rows of cells along which scans look, of some rays that end at ``lengths``; rays of length 7 hit nothing."""

    def __init__(self):
        self.counts, self.marks, self.mapped = (np.zeros((5, 9), dtype=np.uint8) for _ in range(3))
        self.known = 0.0

    def scan(self, *lengths, times=1):
        for _ in range(times):
            rays = np.array(lengths)
            mapped = self.mapped, clearance_of(self.mapped)
            window = count_scan(
                self.counts, self.marks, *mapped, 0.5, 2.5, np.zeros(len(rays)), rays, rays < 7.0, self.known
            )
        return window


def test_marks_need_two_scans_and_six_to_clear():
    row = Row()
    assert row.scan(5.0) == (0, 0, 0, 0)
    assert row.scan(5.0) == (2, 3, 5, 6)
    assert np.argwhere(row.marks).tolist() == [[2, 5]]
    assert row.scan(5.0, times=20) == (0, 0, 0, 0)
    assert row.scan(7.0, times=5) == (0, 0, 0, 0)
    assert row.scan(7.0) == (2, 3, 5, 6)
    assert not row.marks.any()


def test_marks_ignore_a_few_rays_of_a_scan():
    row = Row()
    row.scan(5.0, *[7.0] * 4, times=50)
    assert not row.marks.any()
    row.scan(5.0, times=2)
    row.scan(5.0, *[7.0] * 9, times=50)
    assert row.marks.sum() == 1
    row.scan(5.0, *[7.0] * 10, times=50)
    assert not row.marks.any()


def test_marks_skip_hits_on_or_near_the_map():
    row = Row()
    row.mapped[2, 5] = 1
    row.scan(4.6, times=20)
    assert np.argwhere(row.marks).tolist() == [[2, 5]] or not row.marks.any()
    row.known = 0.3
    row.scan(4.3, times=20)
    assert not row.marks[2, 4]
    row.scan(4.1, times=20)
    assert row.marks[2, 4]


@given(GRIDS, st.integers(0, 2**32 - 1))
def test_marks_isolated_hits_are_near_and_away_from_map(occupied, seed):
    """Compared with numpy, also for rays that leave the grid; hits without such a neighbour are left out."""
    random, clearance = np.random.default_rng(seed), clearance_of(occupied, 8.0)
    x, y = random.uniform(0.0, occupied.shape[::-1])
    angles, ranges, hits = random.uniform(-4, 4, 60), random.uniform(0, 20, 60), random.random(60) < 0.9
    found = hits_apart(occupied, clearance, x, y, angles, ranges, hits, 9.0, 1.3)
    points = np.stack([x + ranges * np.cos(angles), y + ranges * np.sin(angles)], axis=1)
    good = hits & (ranges < 9.0) & ((points >= 0.0) & (points < occupied.shape[::-1])).all(axis=1)
    good &= np.array([distance(occupied, *point) > 1.3 for point in points])
    padded = np.pad(good, 1)
    assert found == pytest.approx(points[good & padded[:-2] & padded[2:]])


def look_at(costmap, smear=0.0, times=20, distance=2.0):
    angles = np.linspace(-0.1, 0.1, 21)
    seen = [costmap.observe(Pose2D(2.0, 3.0), angles, np.full(21, distance), 6.0, smear) for _ in range(times)]
    return any(seen)


def test_marks_ignore_far_hits_of_turning_robot():
    costmap = Costmap(room(), CostmapLimits())
    assert not look_at(costmap, smear=0.1)  # within 0.2 m it can be anywhere
    assert not costmap.has_marks
    assert look_at(costmap, smear=0.02)
    assert costmap.has_marks


def test_marks_of_turning_robot_are_not_cleared_alongside():
    costmap = Costmap(room(), CostmapLimits())
    look_at(costmap)
    marked = costmap.marks.copy()
    look_at(costmap, 0.1, 60, 3.0)
    assert (costmap.marks == marked).all()
    look_at(costmap, 0.0, 60, 3.0)
    assert not (costmap.marks & marked).any()
