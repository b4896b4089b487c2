"""Tight places: gaps with centimetres to spare are driven through; what blinks draws no robot to and fro."""

import numpy as np
import pytest
from navigation_worlds import ERRATIC, LONG, Drive, room, simulation

from rosoclingo.robot.navigation import NavigationOutcome, Pose2D, Velocity
from rosoclingo.robot.navigation.local_planner import STOP, FollowOutcome, VelocityCommand
from rosoclingo.robot.simulation import DoorSpec


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize(
    ("resolution", "gap", "radius"),
    [
        (0.1, 0.4, 0.18),  # 20 mm on either side, and the middle between two cells
        (0.05, 0.4, 0.18),
        (0.05, 0.45, 0.2),
    ],
)
@pytest.mark.parametrize("late", [0, 1])
def test_gaps_with_two_centimetres_to_spare(resolution, gap, radius, late):
    random = np.random.default_rng(round(1000 * gap))
    walls = [(2.9, 0.0, 3.1, 1.5), (2.9, 1.5 + gap, 3.1, 4.0), (1.5, 1.1, 2.2, 1.4)]
    grid = room(6.0, 4.0, resolution, walls)
    drive = Drive(simulation(grid, Pose2D(1.0, 3.0, 2.0), radius=radius), late=late)
    for i in range(4):
        goal = Pose2D((5.0, 1.0)[i % 2], random.uniform(0.5, 3.5), random.uniform(-3.0, 3.0))
        assert drive.to(goal, 120.0).outcome is NavigationOutcome.REACHED
    assert drive.collisions == []
    assert drive.recoveries == []


@pytest.mark.slow
def test_a_way_that_is_open_and_closed_in_turns_is_left_for_another():
    """A door is closed whenever the robot comes near, and open again when it has turned away."""
    walls = [(2.9, 1.5, 3.1, 9.0)]
    door = DoorSpec("door", (3.0, 0.0), (3.0, 1.5), open=True)
    drive = Drive(simulation(room(6.0, 10.0, 0.1, walls), Pose2D(1.0, 0.7), doors=(door,)))

    def blink(drive):
        x, y = drive.robot.pose[:2]
        near = np.hypot(x - 3.0, y - 0.7) < 1.5
        if drive.world.doors["door"].open == near:
            drive.world.set_door("door", not near)
            drive.costmap.forget(x, y)  # as if all of it had been seen
            drive.navigator.obstacles_changed()

    result = drive.to(Pose2D(5.0, 0.7), 400.0, blink)
    assert result.outcome is NavigationOutcome.REACHED
    assert drive.collisions == []


@pytest.mark.slow
def test_a_footprint_goes_round_what_it_does_not_fit_through():
    """The circle within the robot fits through the near gap, the robot does not; through the far one it does."""
    walls = [(2.9, 0.0, 3.1, 1.0), (2.9, 1.3, 3.1, 4.0), (2.9, 4.7, 3.1, 6.0)]
    drive = Drive(simulation(room(walls=walls), Pose2D(1.5, 1.2), footprint=ERRATIC))
    for goal in (Pose2D(4.5, 1.2, 1.0), Pose2D(1.5, 1.2, 3.0)):
        assert drive.to(goal, 90.0).outcome is NavigationOutcome.REACHED
    assert drive.collisions == []
    assert drive.recoveries == []


@pytest.mark.slow
@pytest.mark.parametrize("resolution", [0.1, 0.05])
def test_a_long_footprint_gets_straight_into_a_gap(resolution):
    """The robot cannot turn in the gap, whose way in is askew."""
    walls = [(2.9, 0.0, 3.1, 1.5), (2.9, 2.0, 3.1, 4.0), (1.5, 1.1, 2.2, 1.4)]
    grid = room(6.0, 4.0, resolution, walls)
    drive = Drive(simulation(grid, Pose2D(1.0, 3.0, 2.0), footprint=LONG))
    for goal in (Pose2D(5.0, 1.0, 0.3), Pose2D(1.0, 3.0, 2.0)):
        assert drive.to(goal, 120.0).outcome is NavigationOutcome.REACHED
    assert drive.collisions == []


@pytest.mark.slow
def test_a_footprint_backs_out_of_where_it_cannot_turn():
    """A dead end hardly wider than the robot, into which it has driven."""
    walls = [(2.0, 0.0, 5.0, 2.2), (2.0, 2.7, 5.0, 5.0)]
    drive = Drive(simulation(room(5.0, 5.0, 0.05, walls), Pose2D(1.0, 2.45, 0.0), footprint=LONG))
    assert drive.to(Pose2D(4.0, 2.45, 0.0), 60.0).outcome is NavigationOutcome.REACHED
    assert drive.to(Pose2D(1.0, 4.0, 2.0), 120.0).outcome is NavigationOutcome.REACHED
    assert drive.collisions == []


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("gap", [0.002, 0.01, 0.05, 0.1])
@pytest.mark.parametrize("yaw", [0.0, np.pi])
@pytest.mark.parametrize(("footprint", "side"), [(ERRATIC, 0.175), (LONG, 0.2)])
def test_a_footprint_gets_away_from_a_wall_along_which_it_stands(footprint, side, yaw, gap):
    """There it cannot turn: a corner would touch the wall."""
    drive = Drive(simulation(room(), Pose2D(3.0, 0.1 + side + gap, yaw), footprint=footprint))
    assert drive.to(Pose2D(1.0, 4.0, 0.0), 120.0).outcome is NavigationOutcome.REACHED
    assert drive.collisions == []
    assert drive.recoveries == []


@pytest.mark.mostly_slow
@pytest.mark.parametrize("yaw", [np.pi, 0.5 * np.pi, -0.5 * np.pi])
def test_where_the_last_turn_is_not_possible_yet_the_robot_comes_nearer_to_the_goal(yaw):
    """The goal is 0.3 m behind a gap of 0.5 m; a tolerance of 0.1 m before it, corners of the robot touch the gap's."""
    walls = [(2.5, 0.0, 2.7, 1.75), (2.5, 2.25, 2.7, 4.0)]
    drive = Drive(simulation(room(6.0, 4.0, 0.05, walls), Pose2D(1.0, 2.0, 0.0), footprint=LONG))
    assert drive.to(Pose2D(3.0, 2.0, yaw), 60.0).outcome is NavigationOutcome.REACHED
    assert drive.collisions == []
    assert drive.recoveries == []


@pytest.mark.parametrize(
    ("command", "before", "stops"),
    [((-0.15, -0.4), 0.15, True), ((0.1, 0.2), -0.03, True), ((0.0, 0.4), 0.1, False), ((0.15, 0.4), 0.1, False)],
)
def test_who_turns_round_stops_first(command, before, stops):
    """Else a turn would begin while the robot still drives the other way, into what it was to get away from."""
    found = VelocityCommand(FollowOutcome.DRIVING, Velocity(*command)).stopping_first(Velocity(before, 0.0))
    assert found == VelocityCommand(FollowOutcome.DRIVING, STOP if stops else Velocity(*command))


@pytest.mark.slow
def test_what_could_not_be_got_through_is_gone_round():
    """Behind the near door is a corner that a long robot cannot take; it backs out and takes the far one."""
    walls = [(2.9, 0.0, 3.1, 1.0), (2.9, 1.5, 3.1, 4.6), (3.55, 0.0, 3.65, 2.6), (2.9, 5.1, 3.1, 6.0)]
    drive = Drive(simulation(room(walls=walls), Pose2D(1.5, 1.2), footprint=LONG))
    assert drive.to(Pose2D(4.6, 1.2, 0.0), 300.0).outcome is NavigationOutcome.REACHED
    assert drive.collisions == []
