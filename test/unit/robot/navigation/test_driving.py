"""Navigation drives simulated robots: reachable goals are reached without contact, others end with a reason."""

from pathlib import Path

import numpy as np
import pytest
import yaml
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
from rosoclingo.robot.simulation import DoorSpec, ObstacleSpec, Simulation, load_world

ROOT = Path(__file__).resolve().parents[4]
START = Pose2D(1.0, 1.0)
WALL = (2.9, 0.0, 3.1, 4.0)  # between two halves of a room, with a detour
REACHED = NavigationOutcome.REACHED


@pytest.mark.slow
def test_driving_reaches_the_labels_of_the_office():
    world = Simulation(load_world(ROOT / "worlds" / "office_world.yaml"))
    labels = yaml.safe_load((ROOT / "config" / "office_labels.yaml").read_text())
    drive = Drive(world)
    for name in ("office4", "office2"):
        goal = Pose2D(**labels[name])
        assert drive.to(goal).outcome is REACHED
        assert drive.robot.pose.distance(goal) < 0.15
        assert abs(drive.robot.pose.yaw - goal.yaw) < 0.15
    assert drive.collisions == []


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


@pytest.mark.parametrize(
    ("wall", "goal", "reason"),
    [
        (WALL, Pose2D(3.0, 2.0), "in an obstacle of the map"),
        ((2.9, 0.0, 3.1, 6.0), Pose2D(5.0, 1.0), "no path leads to the goal on the map"),
        (WALL, Pose2D(50.0, 1.0), "off the map"),
    ],
)
def test_driving_to_goal_impossible_by_map_ends_at_once(wall, goal, reason):
    drive = Drive(simulation(room(walls=[wall]), START))
    result = drive.to(goal)
    assert result.outcome is NavigationOutcome.NO_PLAN
    assert reason in result.message
    assert drive.world.time < 1.0


@pytest.mark.slow
def test_driving_to_goal_under_unmapped_obstacle_ends():
    crate = ObstacleSpec("crate", (5.0, 1.0), radius=0.3)
    drive = Drive(simulation(room(), START, obstacles=(crate,)))
    result = drive.to(Pose2D(4.8, 1.0))
    assert result.outcome is NavigationOutcome.NO_PLAN
    assert "an obstacle that is not on the map" in result.message
    assert drive.recoveries == ["conservative_reset", "rotate_recovery", "aggressive_reset", "rotate_recovery"]
    assert drive.collisions == []


# ---- doors --------------------------------------------------------------------------------------------------------


def door_drive(*more):
    """Two halves with a door between them at the bottom and, for some tests, a detour at the top."""
    door = DoorSpec("door", (3.0, 0.0), (3.0, 2.0), open=True)
    return Drive(simulation(room(walls=[(2.9, 2.0, 3.1, 5.0), *more]), START, doors=(door,)))


@pytest.mark.slow
def test_driving_takes_detour_when_a_door_closes():
    drive = door_drive()

    def close(drive):
        if drive.robot.pose.x > 1.8 and drive.world.doors["door"].open:
            drive.world.set_door("door", False)

    assert drive.to(Pose2D(5.0, 1.0), each=close).outcome is REACHED
    assert not drive.world.doors["door"].open
    assert drive.collisions == []


@pytest.mark.slow
@pytest.mark.parametrize("opens", [False, True])
def test_driving_ends_at_closed_door_unless_it_opens(opens):
    drive = door_drive((2.9, 4.9, 3.1, 6.0))
    drive.world.set_door("door", False)

    def reopen(drive):
        if opens and drive.recoveries:
            drive.world.set_door("door", True)

    result = drive.to(Pose2D(5.0, 1.0), limit=300.0, each=reopen)
    assert result.outcome is (REACHED if opens else NavigationOutcome.NO_PLAN)
    assert opens or "blocked by something that is not on the map" in result.message
    assert drive.collisions == []


@pytest.mark.slow
def test_driving_leaves_alternating_door_for_another_way():
    """A door is closed whenever the robot approaches, and open again when it has turned away."""
    door = DoorSpec("door", (3.0, 0.0), (3.0, 1.5), open=True)
    drive = Drive(simulation(room(6.0, 10.0, 0.1, [(2.9, 1.5, 3.1, 9.0)]), Pose2D(1.0, 0.7), doors=(door,)))

    def blink(drive):
        x, y = drive.robot.pose[:2]
        near = np.hypot(x - 3.0, y - 0.7) < 1.5
        if drive.world.doors["door"].open == near:
            drive.world.set_door("door", not near)
            drive.costmap.forget(x, y)  # as if the laser had seen all of it
            drive.navigator.obstacles_changed()

    assert drive.to(Pose2D(5.0, 0.7), 400.0, blink).outcome is REACHED
    assert drive.collisions == []


@pytest.mark.slow
def test_driving_continues_after_robot_is_moved():
    drive = Drive(simulation(room(walls=[WALL]), START))

    def carry(drive):
        if drive.robot.pose.x > 2.0 and drive.robot.pose.y < 3.0 and not carried:
            carried.append(True)
            drive.world.place("robot_0", Pose2D(1.0, 5.0, 0.0))

    carried = []
    assert drive.to(Pose2D(5.0, 1.0), each=carry).outcome is REACHED
    assert carried


# ---- tight places -------------------------------------------------------------------------------------------------


def gap(low, high, top=6.0):
    """Return a wall across a room with a gap in it."""
    return [(2.9, 0.0, 3.1, low), (2.9, high, 3.1, top)]


def places(random, count, low, high):
    """Return goals to and fro between the halves of a room."""
    return [Pose2D((5.0, 1.0)[i % 2], random.uniform(low, high), random.uniform(-3.0, 3.0)) for i in range(count)]


ASKEW = [*gap(1.5, 2.0, 4.0), (1.5, 1.1, 2.2, 1.4)]  # a gap with an oblique entrance
OTHERS = [*gap(1.0, 1.3, 4.0), (2.9, 4.7, 3.1, 6.0)]  # the inscribed circle of the robot fits through the near gap
CORNER = [*gap(1.0, 1.5, 4.6), (3.55, 0.0, 3.65, 2.6), (2.9, 5.1, 3.1, 6.0)]  # behind the near gap, too narrow for LONG
TIGHT = {
    "a rectangle and wide doors": ((8.0, 8.0, 0.05, [(3.9, 0.0, 4.1, 3.4), (3.9, 4.6, 4.1, 8.0)]), Pose2D(1.5, 1.5),
        {"footprint": LONG}, [Pose2D(6.5, 6.5, 0.0), Pose2D(1.5, 6.5, 1.5), Pose2D(6.0, 2.0, -1.5)]),
    "around a gap that is too narrow": ((6.0, 6.0, 0.05, OTHERS), Pose2D(1.5, 1.2), {"footprint": ERRATIC},
        [Pose2D(4.5, 1.2, 1.0), Pose2D(1.5, 1.2, 3.0)]),
    "straight into a gap": ((6.0, 4.0, 0.05, ASKEW), Pose2D(1.0, 3.0, 2.0), {"footprint": LONG},
        [Pose2D(5.0, 1.0, 0.3), Pose2D(1.0, 3.0, 2.0)]),
    "backwards out of a dead end": ((5.0, 5.0, 0.05, [(2.0, 0.0, 5.0, 2.2), (2.0, 2.7, 5.0, 5.0)]),
        Pose2D(1.0, 2.45, 0.0), {"footprint": LONG}, [Pose2D(4.0, 2.45, 0.0), Pose2D(1.0, 4.0, 2.0)]),
    "around an impassable gap": ((6.0, 6.0, 0.05, CORNER), Pose2D(1.5, 1.2), {"footprint": LONG},
        [Pose2D(4.6, 1.2, 0.0)]),
}  # fmt: skip


@pytest.mark.sampled(2)
@pytest.mark.slow
@pytest.mark.parametrize("name", TIGHT)
def test_driving_passes_tight_places(name):
    place, start, body, goals = TIGHT[name]
    drive = Drive(simulation(room(*place), start, **body))
    for goal in goals:
        assert drive.to(goal, 120.0).outcome is REACHED
    assert drive.collisions == []


@pytest.mark.sampled(3)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("resolution", "wide", "radius"),
    [(0.1, 0.4, 0.18), (0.05, 0.4, 0.18), (0.05, 0.45, 0.2)],  # the middle of the first gap lies between two cells
)
@pytest.mark.parametrize("late", [0, 1])
def test_driving_passes_gaps_with_two_centimetres_margin(resolution, wide, radius, late):
    grid = room(6.0, 4.0, resolution, [*gap(1.5, 1.5 + wide, 4.0), (1.5, 1.1, 2.2, 1.4)])
    drive = Drive(simulation(grid, Pose2D(1.0, 3.0, 2.0), radius=radius), late=late)
    for goal in places(np.random.default_rng(round(1000 * wide)), 4, 0.5, 3.5):
        assert drive.to(goal, 120.0).outcome is REACHED
    assert drive.collisions == []
    assert drive.recoveries == []


@pytest.mark.slow
@pytest.mark.parametrize("space", [0.002, 0.01, 0.05, 0.1])
@pytest.mark.parametrize(("footprint", "side", "yaw"), [(ERRATIC, 0.175, 0.0), (LONG, 0.2, np.pi)])
def test_driving_footprint_leaves_a_wall_alongside(footprint, side, yaw, space):
    """There it cannot turn: a corner would touch the wall."""
    drive = Drive(simulation(room(), Pose2D(3.0, 0.1 + side + space, yaw), footprint=footprint))
    assert drive.to(Pose2D(1.0, 4.0, 0.0), 120.0).outcome is REACHED
    assert (drive.collisions, drive.recoveries) == ([], [])


@pytest.mark.mostly_slow
@pytest.mark.parametrize("yaw", [np.pi, 0.5 * np.pi, -0.5 * np.pi])
def test_driving_approaches_goal_if_final_turn_is_blocked(yaw):
    """The goal is 0.3 m behind a gap of 0.5 m; a tolerance of 0.1 m before it, corners of the robot touch the gap's."""
    walls = [(2.5, 0.0, 2.7, 1.75), (2.5, 2.25, 2.7, 4.0)]
    drive = Drive(simulation(room(6.0, 4.0, 0.05, walls), Pose2D(1.0, 2.0, 0.0), footprint=LONG))
    assert drive.to(Pose2D(3.0, 2.0, yaw), 60.0).outcome is REACHED
    assert (drive.collisions, drive.recoveries) == ([], [])


@pytest.mark.mostly_slow
@pytest.mark.parametrize("footprint", [(), LONG])
def test_driving_passes_a_patch_unknown_to_the_map(footprint):
    """The path avoids the patch, as the planner of move_base does; the robot's sides can be over it."""
    grid = room(6.0, 6.0)
    rows, columns = np.indices(grid.shape)
    grid.cells[np.hypot(rows - 60, columns - 60) < 30] = -1
    drive = Drive(simulation(grid, Pose2D(0.6, 2.9), footprint=footprint))
    for goal in (Pose2D(5.4, 3.1, 1.5), Pose2D(3.1, 0.6, 0.0), Pose2D(2.9, 5.4, 0.0)):
        assert drive.to(goal, limit=120.0).outcome is REACHED
    assert drive.collisions == []


@pytest.mark.parametrize(
    ("command", "before", "stops"),
    [((-0.15, -0.4), 0.15, True), ((0.1, 0.2), -0.03, True), ((0.0, 0.4), 0.1, False), ((0.15, 0.4), 0.1, False)],
)
def test_driving_stops_before_a_turn(command, before, stops):
    """Otherwise a turn would begin while the robot still drives the other way, towards the obstacle that it avoids."""
    found = VelocityCommand(FollowOutcome.DRIVING, Velocity(*command)).stopping_first(Velocity(before, 0.0))
    assert found == VelocityCommand(FollowOutcome.DRIVING, STOP if stops else Velocity(*command))


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


def test_navigator_tick_without_goal_is_an_error():
    with pytest.raises(NavigationError):
        Fixed().tick(0.0)


def test_navigator_stops_blind_robot_and_loses_patience():
    """A new scan restores the patience."""
    fixed = Fixed(controller_patience=3.0).start(-2.0)
    fixed.blind(-2.0)
    assert fixed.tick(0.1).velocity != Velocity()
    for now in (1.0, 2.0, 4.0):
        assert fixed.blind(now) == (Velocity(), None)
    assert fixed.blind(4.1).result == (NavigationOutcome.LASER_LOST, "no scan")
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
