"""The node's planning thread: a slow plan delays nothing else, and plans that nobody awaits are cancelled."""

import threading
import time

import numpy as np
import pytest

pytest.importorskip("rospy")
pytest.importorskip("geometry_msgs")
from geometry_msgs.msg import Twist  # noqa: E402
from navigation_worlds import room  # noqa: E402

from rosoclingo.robot.navigation import Costmap, GlobalPlan, GlobalPlanner, PlanOutcome, Pose2D  # noqa: E402
from rosoclingo.robot.nodes.move_base import command_watch, planning_thread  # noqa: E402

PATIENCE = 60.0  # s
START, GOAL = Pose2D(1.0, 1.0), Pose2D(5.0, 1.0)


def wait_until(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        threading.Event().wait(0.005)


class Gated(GlobalPlanner):
    """Plans or returns without a plan on command; ``seen``: the requested goals and costmaps."""

    def __init__(self):
        super().__init__()
        self.gate, self.seen, self.costmaps, self.fails = threading.Event(), [], [], ""

    def plan(self, costmap, start, goal, tolerance=None):
        self.seen.append(goal)
        self.costmaps.append(costmap)
        while not self.gate.wait(0.005):
            if self.is_cancelled():
                return GlobalPlan(PlanOutcome.CANCELLED, np.empty((0, 2)))
        if self.fails:
            raise {"value": ValueError, "exit": SystemExit}[self.fails]("lost")
        return GlobalPlan(PlanOutcome.FOUND, np.array([start[:2], goal[:2]]))


@pytest.fixture
def parts():
    planner = Gated()
    planning = planning_thread.PlanningThread(planner)
    yield planner, Costmap(room()), planning
    planner.gate.set()
    planning.drop()


def answer_of(planning):
    found = []
    wait_until(lambda: found.append(planning.answer()) or found[-1])
    return found[-1]


def test_planning_thread_does_not_block_the_caller(parts):
    planner, costmap, planning = parts
    planning.ask(costmap, START, GOAL)
    for _ in range(5):
        assert planning.answer() is None
    planner.gate.set()
    assert tuple(answer_of(planning).points[-1]) == GOAL[:2]
    assert planning.answer() is None


def test_planning_thread_never_plans_request_dropped_early(parts):
    planner, costmap, planning = parts
    other = planning.submit(costmap, START, START, 0.0)
    planning.ask(costmap, START, GOAL)
    planning.drop()
    planner.gate.set()
    assert other.result(PATIENCE).outcome is PlanOutcome.FOUND
    assert planning.submit(costmap, START, START, 0.0).result(PATIENCE).outcome is PlanOutcome.FOUND
    assert planner.seen == [START, START]


@pytest.mark.parametrize("fails", ["value", "exit"])
def test_planning_thread_raises_planner_errors_to_waiting_caller(parts, fails):
    planner, costmap, planning = parts
    planner.fails = fails
    planner.gate.set()
    planning.ask(costmap, START, GOAL)
    with pytest.raises(Exception, match="lost"):
        answer_of(planning)
    planner.fails = ""
    planning.ask(costmap, START, GOAL)
    assert answer_of(planning).outcome is PlanOutcome.FOUND


# ---- missing commands --------------------------------------------------------------------------------------------


@pytest.fixture
def watched(monkeypatch):
    sent, clock = [], [10.0, 100.0]  # wall time, ROS time
    monkeypatch.setattr(command_watch.time, "monotonic", lambda: clock[0])
    monkeypatch.setattr(command_watch.rospy, "get_time", lambda: clock[1])
    return command_watch.CommandWatch(sent.append, 0.05), sent, clock


def twist(speed):
    message = Twist()
    message.linear.x = speed
    return message


@pytest.mark.parametrize(
    ("speed", "wall", "ros", "stops"),
    [
        (0.3, 1.0, 1.0, True),
        (0.3, 0.4, 0.45, False),  # not late yet
        (0.3, 0.1, 5.0, False),  # simulated time runs fast
        (0.3, 60.0, 0.0, False),  # simulated time stands still
        (0.3, 60.0, -50.0, False),  # ... or went back
        (0.0, 60.0, 60.0, False),  # it stands already
    ],
)
def test_command_watch_stops_robot_without_command_once(watched, speed, wall, ros, stops):
    watch, sent, clock = watched
    watch.command(twist(speed))
    clock[0] += wall
    clock[1] += ros
    assert [watch.check(*clock), watch.check(*clock)] == [stops, False]
    assert [message.linear.x for message in sent] == [speed] + [0.0] * stops
    watch.command(twist(speed))
    assert not watch.check(*clock)
