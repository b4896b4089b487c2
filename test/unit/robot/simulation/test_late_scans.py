"""Scans that are older than their stamps, as those of Stage."""

import numpy as np
import pytest
from navigation_worlds import room, simulation

from rosoclingo.robot.navigation import Pose2D
from rosoclingo.robot.simulation import LaserSpec

WALLS = ((3.0, 0.0, 3.1, 2.4), (3.0, 3.3, 3.1, 6.0), (4.5, 3.0, 6.0, 3.1), (0.8, 4.2, 1.4, 4.6))
START = Pose2D(1.0, 1.0, 0.0)


def late_world(delay, pose=START):
    return simulation(room(walls=WALLS), pose, laser=LaserSpec(range=6.0, noise=0.01, delay=delay))


@pytest.mark.parametrize(("delay", "back", "part"), [(0.0, 0, 0.0), (0.1, 1, 0.0), (0.05, 0, 0.5), (0.25, 2, 0.5)])
def test_late_scan_is_taken_from_an_earlier_position(delay, back, part):
    world, plain = late_world(delay), late_world(0.0)
    poses = [world.robots["robot_0"].pose]
    for _ in range(8):
        world.command("robot_0", 0.4, 1.1)
        world.step()
        poses.append(world.robots["robot_0"].pose)
    plain.place("robot_0", poses[-1 - back].interpolate(poses[-2 - back], part))
    # each scan of a world has different noise
    assert np.abs(world.scan("robot_0") - plain.scan("robot_0")).max() < 0.08
