"""Navigation drives simulated robots: reachable goals are reached without contact, others end with a reason."""

import numpy as np
import pytest
from navigation_worlds import ERRATIC, LONG, Drive, room, simulation
from tour_floors import small_floor
from tours import Tour, Variant

from rosoclingo.robot.navigation import (
    Costmap,
    FollowOutcome,
    GridPlanner,
    NavigationError,
    NavigationOutcome,
    Navigator,
    NavigatorLimits,
    NavigatorState,
    Pose2D,
    RolloutFollower,
    Velocity,
    VelocityCommand,
    default_recoveries,
)
from rosoclingo.robot.navigation.local_planner import STOP
from rosoclingo.robot.simulation import DoorSpec, ObstacleSpec

START = Pose2D(1.0, 1.0)
WALL = (2.9, 0.0, 3.1, 4.0)  # between two halves of a room, with a detour
REACHED = NavigationOutcome.REACHED


@pytest.mark.sampled(2)
@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_driving_tours_random_goals_among_unmapped_obstacles(seed):
    """The tours of bench/tours.py, on a small floor."""
    random = np.random.default_rng(seed)
    tour = Tour(small_floor(random), Variant(), random, 6, 0.0)
    ends = [tour.go() for _ in range(5)]
    assert not [end for end in ends if end.startswith(("MISSED", "NO END"))]
    assert tour.drive.collisions == []


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("wall", "goal", "reason", "latest"),
    [
        (WALL, Pose2D(3.0, 2.0), "in an obstacle of the map", 1.0),
        ((2.9, 0.0, 3.1, 6.0), Pose2D(5.0, 1.0), "no path leads to the goal on the map", 1.0),
        (WALL, Pose2D(50.0, 1.0), "off the map", 1.0),
        (WALL, Pose2D(2.0, 1.0), "an obstacle that is not on the map", 600.0),
    ],
)
def test_driving_to_impossible_goal_ends_with_reason(wall, goal, reason, latest):
    drive = Drive(simulation(room(walls=[wall]), START, obstacles=(ObstacleSpec("crate", (2.2, 1.0), radius=0.3),)))
    result = drive.to(goal)
    assert result.outcome is NavigationOutcome.NO_PLAN
    assert reason in result.message
    assert drive.world.time < latest
    assert drive.collisions == []


# ---- doors --------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("opens", [False, True])
def test_driving_ends_at_closed_door_unless_it_opens(opens):
    """A door between the halves of a room."""
    door = DoorSpec("door", (3.0, 0.0), (3.0, 2.0), open=False)
    drive = Drive(simulation(room(walls=[(2.9, 2.0, 3.1, 6.0)]), START, doors=(door,)))

    def reopen(drive):
        if opens and drive.recoveries:
            drive.world.set_door("door", True)

    result = drive.to(Pose2D(5.0, 1.0), limit=300.0, each=reopen)
    assert result.outcome is (REACHED if opens else NavigationOutcome.NO_PLAN)
    assert opens or "blocked by something that is not on the map" in result.message
    assert drive.collisions == []


# ---- tight places -------------------------------------------------------------------------------------------------

# The inscribed circle of the robot fits through the near gap.
TWO_GAPS = [(2.9, 0.0, 3.1, 1.0), (2.9, 1.3, 3.1, 4.0), (2.9, 4.7, 3.1, 6.0)]
BEHIND = [(2.5, 0.0, 2.7, 1.75), (2.5, 2.25, 2.7, 4.0)]
DEAD_END = [(2.0, 0.0, 5.0, 2.2), (2.0, 2.7, 5.0, 5.0)]
TIGHT = {
    "around a gap that is too narrow": ((6.0, 6.0, 0.05, TWO_GAPS), Pose2D(1.5, 1.2), {"footprint": ERRATIC},
        [Pose2D(4.5, 1.2, 1.0), Pose2D(1.5, 1.2, 3.0)]),
    "backwards out of a dead end": ((5.0, 5.0, 0.05, DEAD_END), Pose2D(1.0, 2.45, 0.0), {"footprint": LONG},
        [Pose2D(4.0, 2.45, 0.0), Pose2D(1.0, 4.0, 2.0)]),
    "a disc with a margin of two centimetres": ((6.0, 4.0, 0.05, [(2.9, 0.0, 3.1, 1.5), (2.9, 1.9, 3.1, 4.0)]),
        Pose2D(1.0, 3.0, 2.0), {"radius": 0.18}, [Pose2D(5.0, 1.0, 0.3)]),
    "a disc through a gap whose middle lies between cells": (
        (6.0, 4.0, 0.1, [(2.9, 0.0, 3.1, 1.5), (2.9, 1.9, 3.1, 4.0)]),
        Pose2D(1.0, 3.0, 2.0), {"radius": 0.18}, [Pose2D(5.0, 1.0, 0.3), Pose2D(1.0, 3.0, 2.0)]),
    "to a goal behind a gap whose corners prevent the turn": ((6.0, 4.0, 0.05, BEHIND), Pose2D(1.0, 2.0, 0.0),
        {"footprint": LONG}, [Pose2D(3.0, 2.0, 0.5 * np.pi)]),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", TIGHT)
def test_driving_passes_tight_places(name):
    place, start, body, goals = TIGHT[name]
    drive = Drive(simulation(room(*place), start, **body))
    for goal in goals:
        assert drive.to(goal, 120.0).outcome is REACHED
    assert drive.collisions == []


# ---- calls without a simulation -----------------------------------------------------------------------------------


class Fixed:
    """A navigator in a room with a goal, for calls without a simulation."""

    def __init__(self, **limits):
        parts = (Costmap(room()), GridPlanner(), RolloutFollower(), default_recoveries(), NavigatorLimits(**limits))
        self.navigator = Navigator(*parts)

    def start(self, now=0.0):
        self.navigator.set_goal(now, Pose2D(5.0, 1.0))
        return self

    def tick(self, now):
        return self.navigator.tick(now, START, Velocity(), 0.1)

    def blind(self, now):
        return self.navigator.stop_blind(now, NavigationOutcome.LASER_LOST, "no scan")


@pytest.mark.parametrize(
    ("command", "before", "stops"),
    [((-0.15, -0.4), 0.15, True), ((0.1, 0.2), -0.03, True), ((0.0, 0.4), 0.1, False), ((0.15, 0.4), 0.1, False)],
)
def test_driving_stops_before_a_turn(command, before, stops):
    """Otherwise a turn would begin while the robot still drives the other way, towards the obstacle that it avoids."""
    found = VelocityCommand(FollowOutcome.DRIVING, Velocity(*command)).stopping_first(Velocity(before, 0.0))
    assert found == VelocityCommand(FollowOutcome.DRIVING, STOP if stops else Velocity(*command))


def test_navigator_tick_without_goal_is_an_error():
    with pytest.raises(NavigationError):
        Fixed().tick(0.0)


class Blocked(RolloutFollower):
    """Reports its path as blocked ``at`` a point (m)."""

    at = (0.0, 0.0)

    def compute(self, costmap, pose, velocity, period):
        return VelocityCommand(FollowOutcome.BLOCKED, at=self.at)


def test_navigator_leaves_path_blocked_at_any_point():
    costmap, goal, follower, paths = Costmap(room(resolution=0.1)), Pose2D(5.0, 4.0), Blocked(), []
    navigator = Navigator(costmap, GridPlanner(), follower, [])
    navigator.on_plan = paths.append
    points = GridPlanner().plan(costmap, START, goal).points
    for place in np.arange(2.0, len(points) - 3.0, 0.5):
        follower.at = tuple(np.interp(place, range(len(points)), axis) for axis in points.T)
        navigator.set_goal(0.0, goal)
        paths.clear()
        for now in (0.0, 0.3):
            navigator.tick(now, START, Velocity(), 0.1)
        assert len(paths) == 2


def test_navigator_stops_blind_robot_and_loses_patience():
    """A new scan restores the patience."""
    fixed = Fixed(controller_patience=3.0).start(-2.0)
    fixed.blind(-2.0)
    assert fixed.tick(0.1).velocity != Velocity()
    for now in (1.0, 2.0, 4.0):
        assert fixed.blind(now) == (Velocity(), None)
    assert fixed.blind(4.1).result == (NavigationOutcome.LASER_LOST, "The laser is lost: no scan")
    assert fixed.navigator.state is NavigatorState.IDLE


def test_navigator_loses_no_patience_when_time_jumps_back():
    fixed, logged = Fixed().start(100.0), []
    fixed.tick(100.1)
    fixed.navigator.on_log = logged.append
    assert fixed.tick(1.0).result is None
    assert fixed.navigator.active
    assert "Time went back" in logged[0]


def test_navigator_handles_cancel_and_new_goal():
    fixed = Fixed()
    fixed.navigator.cancel()
    fixed.start().tick(0.1)
    assert fixed.navigator.state is NavigatorState.CONTROLLING
    fixed.navigator.set_goal(0.2, Pose2D(1.0, 5.0))
    assert fixed.navigator.state is NavigatorState.PLANNING
    fixed.navigator.cancel()
    assert not fixed.navigator.active
