"""Scans that are older than they say, as those of Stage: the delay is found, and no walls appear beside walls."""

import functools
import math

import numpy as np
import pytest
from navigation_worlds import Drive, room, simulation

from rosoclingo.robot.navigation import Costmap, CostmapLimits, Pose2D, ScanDelay
from rosoclingo.robot.simulation import LaserSpec, ObstacleSpec

WALLS = ((3.0, 0.0, 3.1, 2.4), (3.0, 3.3, 3.1, 6.0), (4.5, 3.0, 6.0, 3.1), (0.8, 4.2, 1.4, 4.6))
START = Pose2D(1.0, 1.0, 0.0)
LASER = LaserSpec(range=6.0, noise=0.01)


class Late(Drive):
    """A drive that knows where the laser was at each stamp, and places its scans as the node does."""

    def __init__(self, *arguments, **more):
        super().__init__(*arguments, **more)
        self.delay, self.path = ScanDelay(), []

    def look(self):
        self.path.append(self.robot.pose)
        laser = self.robot.lasers[0]
        ranges = self.world.scan(self.robot.spec.name).astype(np.float64)
        rate = self.delay.see(
            self.costmap, laser.angles, np.where(ranges < laser.spec.range, ranges, np.nan), self.where
        )
        smear = abs(rate) * self.delay.doubt
        pose = self.where(self.delay.delay) or self.where(0.0)
        if self.costmap.observe(pose, laser.angles, ranges, laser.spec.range, smear):
            self.navigator.obstacles_changed()

    def where(self, before):
        """The laser's pose so many s before now, as tf tells it."""
        steps = before / self.world.spec.interval
        whole = int(steps + 1e-9)
        if whole + 1 >= len(self.path):
            return self.path[-1].compose(self.robot.lasers[0].spec.pose) if before == 0.0 else None
        pose = self.path[-1 - whole].towards(self.path[-2 - whole], max(0.0, steps - whole))
        return pose.compose(self.robot.lasers[0].spec.pose)


def late_world(delay, things=(), walls=WALLS, pose=START, interval=0.1):
    world = simulation(room(walls=walls), pose, obstacles=things, laser=LASER._replace(delay=delay))
    world.spec = world.spec._replace(interval=interval)
    return world


def wrong_marks(drive, things=()):
    """The number of cells marked that are further than 0.1 m from all that stands there."""
    cells = np.argwhere(drive.costmap.marks)
    points = [drive.costmap.grid.centre(*cell) for cell in cells]
    return sum(all(math.dist(point, thing.at) > thing.radius + 0.1 for thing in things) for point in points)


@pytest.mark.parametrize(("delay", "back", "part"), [(0.0, 0, 0.0), (0.1, 1, 0.0), (0.05, 0, 0.5), (0.25, 2, 0.5)])
def test_a_late_scan_is_that_from_where_the_robot_was(delay, back, part):
    world, plain = late_world(delay), late_world(0.0)
    for each in (world, plain):
        each.spec = each.spec._replace(robots=())
    poses = [world.robots["robot_0"].pose]
    for _ in range(8):
        world.command("robot_0", 0.4, 1.1)
        world.step()
        poses.append(world.robots["robot_0"].pose)
    seen_from = poses[-1 - back].towards(poses[-2 - back], part)
    plain.place("robot_0", seen_from)
    # The noise is another one in each scan of a world.
    assert np.abs(world.scan("robot_0") - plain.scan("robot_0")).max() < 0.08


def test_who_is_carried_away_sees_what_is_there():
    world = late_world(0.5)
    for _ in range(9):
        world.command("robot_0", 0.4, 0.0)
        world.step()
    world.place("robot_0", Pose2D(5.0, 5.0, 1.0))
    plain = late_world(0.0, pose=Pose2D(5.0, 5.0, 1.0))
    assert np.abs(world.scan("robot_0") - plain.scan("robot_0")).max() < 0.08


@pytest.mark.parametrize("interval", [0.05, 0.1])
@pytest.mark.parametrize("delay", [0.0, 0.05, 0.1, 0.2, 0.3])
def test_the_delay_is_found(delay, interval):
    drive = Late(late_world(delay, interval=interval))
    for _ in range(round(3.0 / interval)):
        drive.look()
        drive.world.command("robot_0", 0.0, 1.0)
        drive.world.step()
    assert drive.delay.delay == pytest.approx(delay, abs=0.026)
    assert drive.delay.doubt < 0.05


def test_without_anything_to_see_nothing_is_found():
    world = simulation(room(30.0, 30.0), Pose2D(15.0, 15.0), laser=LASER._replace(delay=0.2))
    drive = Late(world)
    for _ in range(40):
        drive.look()
        world.command("robot_0", 0.0, 1.0)
        world.step()
    assert (drive.delay.delay, drive.delay.doubt) == (0.0, 0.1)


@pytest.mark.slow
@pytest.mark.parametrize("delay", [0.0, 0.1, 0.2])
def test_no_walls_beside_walls(delay):
    """Where scans are put at their stamps' poses, and turns are not heeded, hundreds of cells are marked."""
    things = (ObstacleSpec("box", (2.0, 3.0), 0.15), ObstacleSpec("bin", (4.6, 1.5), 0.2))
    goals = (Pose2D(5.0, 2.0, math.pi), Pose2D(1.0, 5.4, 0.0), Pose2D(5.2, 5.0, -1.0), Pose2D(1.0, 1.0, 2.0))
    drive = Late(late_world(delay, things))
    for goal in goals:
        assert drive.to(goal).message == "Goal reached."
    assert drive.collisions == []
    assert wrong_marks(drive, things) <= 3
    assert drive.costmap.marks.any(), "what the map lacks is marked"
    assert drive.world.time < 90.0
    if delay:
        careless = Drive(late_world(delay, things))
        wrong = []
        for goal in goals[:2]:
            careless.to(goal, each=lambda drive: wrong.append(wrong_marks(drive, things)))
        assert max(wrong) > 30


def test_far_hits_of_who_turns_do_not_count():
    costmap = Costmap(room(), CostmapLimits())
    angles, ranges = np.array([0.0, 0.01]), np.array([2.0, 2.0])
    seen = functools.partial(costmap.observe, Pose2D(2.0, 3.0), angles, ranges, 6.0)
    for _ in range(20):
        assert not seen(smear=0.1)  # within 0.2 m it may be anywhere
    assert not costmap.has_marks
    assert any(seen(smear=0.02) for _ in range(20))
    assert costmap.has_marks


def test_who_turns_does_not_clear_what_may_be_beside():
    costmap = Costmap(room(), CostmapLimits())
    angles = np.linspace(-0.1, 0.1, 21)
    for _ in range(20):
        costmap.observe(Pose2D(2.0, 3.0), angles, np.full(21, 2.0), 6.0)
    marked = costmap.marks.copy()
    for _ in range(60):
        costmap.observe(Pose2D(2.0, 3.0), angles, np.full(21, 3.0), 6.0, smear=0.1)
    assert (costmap.marks == marked).all()
    for _ in range(60):
        costmap.observe(Pose2D(2.0, 3.0), angles, np.full(21, 3.0), 6.0)
    assert not (costmap.marks & marked).any()
