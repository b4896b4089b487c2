"""Slow planning: the robot continues or stands meanwhile, and requests that nobody needs are cancelled."""

import math

import numpy as np
import pytest
from navigation_worlds import Drive, room, simulation

from rosoclingo.robot.navigation import (
    Costmap,
    CostmapLimits,
    GridPlanner,
    NavigatorState,
    OccupancyGrid,
    PlanOutcome,
    Pose2D,
)
from rosoclingo.robot.navigation.planning import Planning
from rosoclingo.robot.simulation import ObstacleSpec

WALLS = ((3.0, 0.0, 3.1, 2.4), (3.0, 3.3, 3.1, 6.0))
START, GOAL = Pose2D(1.0, 1.0), Pose2D(5.0, 1.0)


class LatePlanning(Planning):
    """Delivers the immediate plan after a number of polls."""

    def __init__(self, planner, late):
        super().__init__(planner)
        self.late, self.left, self.asked, self.dropped = late, 0, 0, 0

    def ask(self, costmap, start, goal):
        super().ask(costmap, start, goal)
        self.left, self.asked = self.late, self.asked + 1

    def answer(self):
        self.left -= 1
        return super().answer() if self.left < 0 else None

    def drop(self):
        super().drop()
        self.dropped += 1


def late_drive(late, things=()):
    drive = Drive(simulation(room(walls=WALLS), START, obstacles=things))
    drive.navigator.planning = LatePlanning(GridPlanner(), late)
    return drive


@pytest.mark.slow
@pytest.mark.once
def test_late_plan_robot_waits_first_and_drives_during_replanning():
    drive = late_drive(30, (ObstacleSpec("box", (3.05, 2.6), 0.1),))
    planning, speeds = drive.navigator.planning, []
    drive.navigator.set_goal(0.0, GOAL)
    while drive.world.time < 2.95:
        assert drive.step() is None
        assert drive.robot.v == drive.robot.w == 0.0
    assert planning.asked == 1

    def note(drive):
        if planning.left >= 0 and planning.asked > 1:
            speeds.append(drive.robot.v)

    assert drive.to(GOAL, each=note).message == "Goal reached."
    assert drive.collisions == []
    assert planning.asked > 2, "an unmapped obstacle makes it plan again"
    assert max(speeds) > 0.5, "it was driven while a plan was looked for"


@pytest.mark.slow
def test_late_plan_is_followed_from_present_position():
    """Otherwise the robot would return to where it was when it asked for the plan."""
    prompt, late = late_drive(0), late_drive(25)
    took = []
    for drive in (prompt, late):
        began = []

        def note(drive, began=began):
            drive.navigator.obstacles_changed()
            if not began and drive.robot.v > 0.0:
                began.append(drive.world.time)
            assert drive.robot.v > -0.01

        assert drive.to(GOAL, each=note).message == "Goal reached."
        took.append(drive.world.time - began[0])
    assert took[1] < 1.2 * took[0]


@pytest.mark.parametrize("end", ["cancel", "goal", "map", "blind"])
def test_late_plan_that_is_obsolete_is_dropped(end):
    drive = late_drive(10000)
    navigator, planning = drive.navigator, drive.navigator.planning
    navigator.set_goal(0.0, GOAL)
    drive.step()
    assert navigator.state is NavigatorState.PLANNING
    assert (planning.asked, planning.dropped) == (1, 0)
    if end == "cancel":
        navigator.cancel()
        assert not navigator.active
        navigator.set_goal(1.0, GOAL)
    elif end == "goal":
        navigator.set_goal(1.0, Pose2D(1.0, 5.0))
    elif end == "map":
        navigator.take_map(Costmap(room(walls=WALLS)))
    else:
        navigator.stop_blind(1.0, None, "")
        navigator.stop_blind(100.0, None, "")
        assert not navigator.active
        navigator.set_goal(101.0, GOAL)
    assert planning.dropped == 1
    planning.late = 0
    assert drive.step() is None
    assert planning.asked == 2
    assert navigator.state is NavigatorState.CONTROLLING


@pytest.mark.slow
def test_late_plan_costs_no_patience():
    drive = late_drive(300)
    assert drive.to(GOAL).message == "Goal reached."
    assert drive.recoveries == []
    assert drive.world.time > 30.0


def test_planning_snapshot_keeps_the_costmap_unchanged():
    costmap = Costmap(room(walls=WALLS))
    angles, planner = np.linspace(-math.pi, math.pi, 90), GridPlanner()
    before, way = costmap.snapshot(), planner.plan(costmap, START, GOAL).points
    for _ in range(10):
        costmap.observe(Pose2D(3.0, 2.8), angles, np.full(90, 0.6), 6.0)
    costmap.bar(2.0, 2.0)
    assert costmap.has_marks
    assert not before.has_marks
    assert np.array_equal(planner.plan(before, START, GOAL).points, way)
    assert not np.array_equal(planner.plan(costmap.snapshot(), START, GOAL).points, way)


@pytest.mark.slow
def test_planning_on_a_big_map_can_be_cancelled():
    cells = np.zeros((4000, 4000), dtype=np.int8)
    cells[::60], cells[:, ::60] = 100, 100
    for at in range(30, 4000, 60):
        cells[:, at : at + 12] = cells[at : at + 12] = 0
    costmap = Costmap(OccupancyGrid(cells, 0.05), CostmapLimits(inflation_radius=0.3))
    planner, ends = GridPlanner(), (Pose2D(1.8, 1.8), Pose2D(196.8, 196.8))
    planner.cancelled[0] = True
    assert planner.plan(costmap, *ends).outcome is PlanOutcome.CANCELLED
    planner.cancelled[0] = False
    assert planner.plan(costmap, ends[0], Pose2D(20.0, 20.0)).outcome is PlanOutcome.FOUND
