"""Slow planning: the robot continues or stands meanwhile, and requests that nobody needs are cancelled."""

import math

import numpy as np
import pytest
from navigation_worlds import Drive, room, simulation

from rosoclingo.robot.navigation import (
    Costmap,
    GridPlanner,
    NavigationOutcome,
    NavigatorState,
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
        navigator.stop_blind(1.0, NavigationOutcome.LASER_LOST, "")
        navigator.stop_blind(100.0, NavigationOutcome.LASER_LOST, "")
        assert not navigator.active
        navigator.set_goal(101.0, GOAL)
    assert planning.dropped == 1
    planning.late = 0
    assert drive.step() is None
    assert planning.asked == 2
    assert navigator.state is NavigatorState.CONTROLLING


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
    planner.cancelled[0] = True
    assert planner.plan(costmap, START, GOAL).outcome is PlanOutcome.CANCELLED
