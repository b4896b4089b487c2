"""Every beam of any laser compared with a caster that examines each object in the world separately."""

import contextlib
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_bodies import bodies, doors, obstacles, poses, start, walled
from world_reference import Things, cast

from rosoclingo.robot.navigation import OccupancyGrid, Pose2D
from rosoclingo.robot.simulation import DoorSpec, LaserSpec, RobotSpec, Simulation, WorldError, WorldSpec

HAIR = 1e-7  # m: a ray that passes an edge this closely can hit or miss it

mounts = st.builds(Pose2D, st.floats(-4.0, 4.0), st.floats(-4.0, 4.0), st.floats(-7.0, 7.0))
lasers = st.builds(
    LaserSpec,
    range=st.floats(0.05, 12.0),
    angle=st.one_of(st.sampled_from([0.0, 90.0, 180.0, 270.0, 360.0]), st.floats(0.0, 360.0)),
    beams=st.integers(2, 40),
    noise=st.just(0.0),
    rate=st.just(10.0),
    pose=st.one_of(st.just(Pose2D(0.05, 0.0)), mounts),
    min_range=st.sampled_from([0.0, 0.04]),
)


@given(
    st.integers(0, 999), st.sampled_from([0.05, 0.1, 0.5]), st.integers(0, 30), st.tuples(bodies, bodies),
    st.lists(poses, min_size=2, max_size=12), st.tuples(doors, doors), st.lists(obstacles, max_size=3),
    st.lists(lasers, min_size=1, max_size=3), st.tuples(st.booleans(), st.booleans()),
)  # fmt: skip
def test_laser_beams_match_the_reference_caster(
    seed, resolution, pillars, pair, places, gates, things, scanners, opened
):
    """The first robot has lasers; the second one, doors, obstacles and walls can block them."""
    gates = tuple(DoorSpec(str(i), d[:2], d[2:], open=True) for i, d in enumerate(gates))
    pair = ({**pair[0], "lasers": tuple(scanners)}, pair[1])
    world = start(walled(seed, resolution, pillars), pair, places, gates)
    if world is None:
        return
    changes = [lambda thing=thing: world.put_obstacle(thing) for thing in things]
    changes += [lambda i=i: world.set_door(str(i), opened[i]) for i in (0, 1)]
    for change in changes:
        with contextlib.suppress(WorldError):
            change()
        for i in range(len(scanners)):
            check(world, "a", i)


def check(world, name, number):
    robot, laser = world.robots[name], world.robots[name].lasers[number]
    spec, things = laser.spec, Things(world, name)
    eye = robot.pose.compose(spec.pose)
    angles = eye.yaw + np.radians(np.linspace(-spec.angle / 2, spec.angle / 2, spec.beams))
    near, far = (cast(things, eye.x, eye.y, angles, spec.range, grown) for grown in (HAIR, -HAIR))
    found = world.scan(name, number)
    assert found.dtype == np.float32
    low, high = (np.clip(ranges, spec.min_range, spec.range) for ranges in (near, far))
    assert (found >= low - 1e-5).all(), (found - low, angles)
    assert (found <= high + 1e-5).all(), (found - high, angles)


@pytest.mark.parametrize("noise", [0.02, 5.0])
def test_laser_noise_affects_hits_and_stays_within_range(noise):
    cells = np.zeros((80, 80), dtype=np.int8)
    cells[:, 0] = 100
    laser = LaserSpec(3.0, 360.0, 180, noise, min_range=0.1, pose=Pose2D(0.0, 0.0))
    world = Simulation(WorldSpec(OccupancyGrid(cells, 0.1), (RobotSpec("a", Pose2D(1.1, 4.0), lasers=(laser,)),)))
    exact = cast(Things(world, "a"), 1.1, 4.0, world.robots["a"].lasers[0].angles, 3.0, 0.0)
    scans = np.array([world.scan("a") for _ in range(300)])
    assert scans.min() >= np.float32(0.1)
    assert scans.max() <= np.float32(3.0)
    assert (scans[:, exact >= 3.0] == np.float32(3.0)).all()
    if noise < 1.0:
        hit = exact < 2.7
        assert np.abs((scans - exact)[:, hit].mean(axis=0)).max() < 5 * noise / math.sqrt(300)
        assert abs((scans - exact)[:, hit].std() / noise - 1.0) < 0.05
