"""What rays mark on a costmap and what they clear."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from occupied_grids import GRIDS, clearance_of, distance

from rosoclingo.robot.navigation.compiled.marks import Evidence, Mapped, Rules, count_rays, hits_apart


class Counted:
    """Counts and marks of rows of cells that one ray at a time looks along, ``spacing`` rad from the next."""

    def __init__(self, spacing=0.0):
        counts, self.marks, self.mapped = (np.zeros((5, 9), dtype=np.uint8) for _ in range(3))
        self.evidence = Evidence(counts, self.marks, np.zeros((5, 9, 2), dtype=np.uint8))
        self.spacing, self.known = spacing, 0.0

    def ray(self, length, hit=True, times=1, y=2.5):
        for _ in range(times):
            window = count_rays(
                self.evidence,
                Mapped(self.mapped, clearance_of(self.mapped)),
                0.5,
                y,
                np.zeros(1),
                np.array([length]),
                np.array([hit]),
                Rules(2, 24, 8, self.known, 0.2, self.spacing),
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


@pytest.mark.parametrize(
    ("spacing", "times", "beside", "through"),
    [
        (0.0, 100, 2.4, 2.25),
        (0.2, 24, 2.7, 2.5),  # rays some 0.9 cells apart there: one that passes by will do
    ],
)
def test_what_fills_a_part_of_a_cell_is_not_cleared_by_what_passes_beside_it(spacing, times, beside, through):
    row = Counted(spacing)
    row.ray(5.2, times=12, y=2.1)
    row.ray(7.0, hit=False, times=times, y=beside)
    assert row.marks.sum() == 1
    row.ray(7.0, hit=False, times=24, y=through)
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
    row.ray(4.7, times=20)
    assert not row.marks.any()


def test_hits_next_to_what_is_on_the_map_are_left_out_too():
    row = Counted()
    row.mapped[2, 5], row.known = 1, 0.3
    row.ray(4.3, times=20)
    assert not row.marks.any()
    row.ray(4.1, times=20)
    assert np.argwhere(row.marks).tolist() == [[2, 4]]


@given(GRIDS, st.integers(0, 2**32 - 1))
def test_hits_apart_are_those_near_and_away_from_what_is_known(occupied, seed):
    """Against the same by numpy, with rays that leave the grid too."""
    random, clearance = np.random.default_rng(seed), clearance_of(occupied, 8.0)
    x, y = random.uniform(0.0, occupied.shape[::-1])
    angles, ranges, hits = random.uniform(-4, 4, 60), random.uniform(0, 20, 60), random.random(60) < 0.8
    found = hits_apart(Mapped(occupied, clearance), x, y, angles, ranges, hits, 9.0, 1.3)
    points = np.stack([x + ranges * np.cos(angles), y + ranges * np.sin(angles)], axis=1)[hits & (ranges < 9.0)]
    points = points[((points >= 0.0) & (points < occupied.shape[::-1])).all(axis=1)]
    assert found == pytest.approx(points[np.array([distance(occupied, *point) for point in points]) > 1.3])
