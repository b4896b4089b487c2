"""What scans mark on a costmap and what they clear."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from navigation_worlds import room, simulation
from occupied_grids import GRIDS, clearance_of, distance

from rosoclingo.robot.navigation import Costmap, CostmapLimits, Pose2D
from rosoclingo.robot.navigation.compiled.marks import count_scan, hits_apart
from rosoclingo.robot.simulation import LaserSpec, ObstacleSpec


class Row:
    """Rows of cells along which scans look, of some rays that end at ``lengths``; those of 7 hit nothing."""

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


def test_a_cell_is_marked_by_the_second_scan_and_cleared_by_the_sixth():
    row = Row()
    assert row.scan(5.0) == (0, 0, 0, 0)
    assert row.scan(5.0) == (2, 3, 5, 6)
    assert np.argwhere(row.marks).tolist() == [[2, 5]]
    assert row.scan(5.0, times=20) == (0, 0, 0, 0)
    assert row.scan(7.0, times=5) == (0, 0, 0, 0)
    assert row.scan(7.0) == (2, 3, 5, 6)
    assert not row.marks.any()


def test_a_few_rays_of_a_scan_mark_nothing_and_clear_nothing():
    row = Row()
    row.scan(5.0, *[7.0] * 4, times=50)
    assert not row.marks.any()
    row.scan(5.0, times=2)
    row.scan(5.0, *[7.0] * 9, times=50)
    assert row.marks.sum() == 1
    row.scan(5.0, *[7.0] * 10, times=50)
    assert not row.marks.any()


def test_scans_that_seldom_show_something_are_noise():
    row = Row()
    for _ in range(50):
        row.scan(5.0)
        row.scan(7.0, times=2)
    assert not row.marks.any()


def test_hits_on_the_map_and_next_to_it_are_left_out():
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
def test_hits_apart_are_those_near_and_away_from_what_is_known(occupied, seed):
    """Against the same by numpy, with rays that leave the grid too; those without such a neighbour are left out."""
    random, clearance = np.random.default_rng(seed), clearance_of(occupied, 8.0)
    x, y = random.uniform(0.0, occupied.shape[::-1])
    angles, ranges, hits = random.uniform(-4, 4, 60), random.uniform(0, 20, 60), random.random(60) < 0.9
    found = hits_apart(occupied, clearance, x, y, angles, ranges, hits, 9.0, 1.3)
    points = np.stack([x + ranges * np.cos(angles), y + ranges * np.sin(angles)], axis=1)
    good = hits & (ranges < 9.0) & ((points >= 0.0) & (points < occupied.shape[::-1])).all(axis=1)
    good &= np.array([distance(occupied, *point) > 1.3 for point in points])
    padded = np.pad(good, 1)
    assert found == pytest.approx(points[good & padded[:-2] & padded[2:]])


@pytest.mark.parametrize("noise", [0.0, 0.01, 0.03])
def test_noise_marks_few_cells_before_walls_and_things(noise):
    walls = [(1.0, 4.0, 2.0, 4.3), (4.0, 1.0, 4.4, 3.0)]
    thing = ObstacleSpec("disc", (3.0, 4.5), radius=0.2)
    laser = LaserSpec(range=6.0, noise=noise, beams=1081)
    world = simulation(room(walls=walls), Pose2D(3.0, 3.0, 0.4), (), (thing,), laser)
    costmap, robot = Costmap(world.spec.grid), world.robots["robot_0"]
    for _ in range(30):
        sensor = robot.pose.compose(robot.lasers[0].spec.pose)
        costmap.observe(sensor, robot.lasers[0].angles, world.scan("robot_0").astype(np.float64), 6.0)
    centres = [costmap.grid.centre(*cell) for cell in np.argwhere(costmap.marks)]
    wrong = [one for one in centres if math.dist(one, thing.at) > thing.radius + 0.05 + 2.0 * noise]
    assert len(centres) - len(wrong) >= 4
    assert len(wrong) <= (0 if noise < 0.03 else 60)


def look_at(costmap, smear=0.0, times=20, distance=2.0):
    angles = np.linspace(-0.1, 0.1, 21)
    seen = [costmap.observe(Pose2D(2.0, 3.0), angles, np.full(21, distance), 6.0, smear) for _ in range(times)]
    return any(seen)


def test_far_hits_of_a_robot_that_turns_do_not_count():
    costmap = Costmap(room(), CostmapLimits())
    assert not look_at(costmap, smear=0.1)  # within 0.2 m it may be anywhere
    assert not costmap.has_marks
    assert look_at(costmap, smear=0.02)
    assert costmap.has_marks


def test_a_robot_that_turns_does_not_clear_what_can_be_beside():
    costmap = Costmap(room(), CostmapLimits())
    look_at(costmap)
    marked = costmap.marks.copy()
    look_at(costmap, 0.1, 60, 3.0)
    assert (costmap.marks == marked).all()
    look_at(costmap, 0.0, 60, 3.0)
    assert not (costmap.marks & marked).any()
