"""How noisy a laser is, told from its scans alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from navigation_worlds import room, simulation

from rosoclingo.robot.navigation import Costmap, CostmapLimits, Pose2D
from rosoclingo.robot.navigation.scan_noise import ScanNoise
from rosoclingo.robot.simulation import LaserSpec, ObstacleSpec


def scans(noise, count=10, beams=1081, obstacles=()):
    laser = LaserSpec(range=6.0, noise=noise, beams=beams)
    walls = [(1.0, 4.0, 2.0, 4.3), (4.0, 1.0, 4.4, 3.0)]
    world = simulation(room(walls=walls), Pose2D(3.0, 3.0, 0.4), (), obstacles, laser)
    return [world.scan("robot_0").astype(np.float64) for _ in range(count)], world


@pytest.mark.parametrize("noise", [0.0, 0.005, 0.01, 0.03, 0.1])
def test_the_deviation_of_a_laser(noise):
    found = ScanNoise()
    for ranges in scans(noise)[0]:
        found.see(ranges)
    assert found.deviation == pytest.approx(noise, rel=0.15, abs=0.001)


@given(st.integers(0, 2**32 - 1), st.integers(0, 12), st.floats(0.0, 0.05))
def test_any_scan_will_do(seed, beams, noise):
    """Few beams, beams that hit nothing: no fault, and no deviation without a hit."""
    random, found = np.random.default_rng(seed), ScanNoise()
    ranges = 2.0 + noise * random.standard_normal(beams)
    ranges[random.random(beams) < 0.5] = np.nan
    found.see(ranges)
    assert np.isfinite(found.deviation)
    ScanNoise().see(np.full(beams, np.nan))


@pytest.mark.parametrize(("noise", "most", "marked"), [(0.005, 0.1, True), (0.03, 0.1, False), (0.03, 0.0, True)])
def test_what_stands_out_little_from_a_wall_is_marked_if_the_laser_is_good_enough_to_tell(noise, most, marked):
    """A disc whose edge is 5 cm before the wall; with 3 cm of noise that may be the wall itself."""
    found, world = scans(noise, 30, obstacles=[ObstacleSpec("disc", (3.0, 5.95), radius=0.1)])
    costmap, robot = Costmap(world.spec.grid, CostmapLimits(most_tolerance=most)), world.robots["robot_0"]
    for ranges in found:
        costmap.observe(robot.pose.compose(robot.lasers[0].spec.pose), robot.lasers[0].angles, ranges, 6.0)
    assert costmap.has_marks is marked


@pytest.mark.parametrize("noise", [0.01, 0.03])
@pytest.mark.parametrize("away", [0.4, 1.0, 3.0])
def test_what_noise_scatters_into_the_cells_before_marks_few_of_them(noise, away):
    """A wall's face, one standard deviation behind an edge between cells: every sixth hit is before the edge."""
    random = np.random.default_rng(3)
    costmap, sensor = Costmap(room(resolution=0.1)), Pose2D(4.0 - away, 3.05)
    angles, marked = np.linspace(-0.3, 0.3, 61), 0
    for _ in range(300):
        ranges = (4.0 + noise - sensor.x) / np.cos(angles) + random.normal(0.0, noise, len(angles))
        costmap.observe(sensor, angles, ranges, 6.0)
        marked += costmap.marks[:, 39].sum()
    assert costmap.marks[30, 40]
    assert marked / 300 < 0.1 * costmap.marks[:, 40].sum()
