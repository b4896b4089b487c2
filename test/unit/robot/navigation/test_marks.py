"""Which hits of a scan mark cells of a costmap; test_parameter_effects.py has the effects of its parameters."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from navigation_worlds import room
from occupied_grids import GRIDS, clearance_of, distance

from rosoclingo.robot.navigation import Costmap, CostmapLimits, Pose2D
from rosoclingo.robot.navigation.compiled.marks import hits_apart


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
