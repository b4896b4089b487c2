"""The node's own planning: what holds up a plan holds up nothing else, and what nobody waits for is given up."""

import contextlib
import queue
import threading
import time

import numpy as np
import pytest

pytest.importorskip("rospy")
pytest.importorskip("geometry_msgs")
from geometry_msgs.msg import Twist  # noqa: E402
from navigation_worlds import room  # noqa: E402

from rosoclingo.robot.navigation import Costmap, GlobalPlanner, Plan, PlanOutcome, Pose2D  # noqa: E402
from rosoclingo.robot.nodes.move_base import command_watch, planning_thread  # noqa: E402

PATIENCE = 60.0  # s
START, GOAL = Pose2D(1.0, 1.0), Pose2D(5.0, 1.0)


class Worker:
    """The test's own thread is the worker's."""

    def __init__(self):
        self.jobs = queue.Queue()
        self.put = self.jobs.put

    def until(self, condition):
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end
            with contextlib.suppress(queue.Empty):
                self.jobs.get(timeout=0.01)()


class Gated(GlobalPlanner):
    """Plans when it is told to, or gives up; ``seen``: the goals that it was asked for."""

    def __init__(self):
        super().__init__()
        self.gate, self.seen, self.prepared, self.fails = threading.Event(), [], 0, ""

    def plan(self, costmap, start, goal, tolerance=None):
        self.seen.append(goal)
        while not self.gate.wait(0.005):
            if not self.wanted():
                return Plan(PlanOutcome.GIVEN_UP, np.empty((0, 2)))
        if self.fails:
            raise {"value": ValueError, "exit": SystemExit}[self.fails]("lost")
        return Plan(PlanOutcome.FOUND, np.array([start[:2], goal[:2]]))

    def prepare(self, costmap):
        self.prepared += 1
        if self.fails:
            raise ValueError("lost")
        return self.prepared < 3


@pytest.fixture
def parts():
    worker, planner = Worker(), Gated()
    costmap, planning = Costmap(room()), planning_thread.PlanningThread(worker, planner)
    planning.take_map(costmap)
    worker.until(lambda: planner.prepared == 3 and planning._idle)
    yield worker, planner, costmap, planning
    planner.gate.set()
    planning.drop()


def test_the_asker_goes_on_while_it_is_planned(parts):
    worker, planner, costmap, planning = parts
    planning.ask(costmap, START, GOAL)
    for _ in range(5):
        assert planning.answer() is None
    planner.gate.set()
    found = []
    worker.until(lambda: found.append(planning.answer()) or found[-1])
    assert tuple(found[-1].points[-1]) == GOAL[:2]
    assert planning.answer() is None


def test_a_short_plan_is_there_at_once(parts):
    _, planner, costmap, planning = parts
    planner.gate.set()
    answers = []
    for _ in range(20):  # on a machine under load it may be late now and then
        planning.ask(costmap, START, GOAL)
        answers.append(planning.answer())
    assert any(answers)


def test_what_is_dropped_is_given_up(parts):
    worker, planner, costmap, planning = parts
    planning.ask(costmap, START, GOAL)
    running = planning._running
    planning.ask(costmap, START, START)
    worker.until(running.future.done)
    assert running.future.result().outcome is PlanOutcome.GIVEN_UP
    worker.until(lambda: planner.seen == [GOAL, START])
    planning.drop()
    worker.until(lambda: planning._idle)
    assert planning.answer() is None


def test_the_navigator_comes_before_those_who_only_ask(parts):
    worker, planner, costmap, planning = parts
    others = [planning.also(START, Pose2D(x, 2.0), 0.0) for x in (1.0, 2.0)]
    planning.ask(costmap, START, GOAL)
    planner.gate.set()
    worker.until(lambda: all(other.done() for other in others))
    assert planner.seen == [Pose2D(1.0, 2.0), GOAL, Pose2D(2.0, 2.0)]
    assert planning.answer().outcome is PlanOutcome.FOUND


def test_plans_are_on_the_costmap_of_when_they_begin(parts):
    worker, planner, costmap, planning = parts
    twins = []
    planner.plan = lambda twin, *ends: twins.append(twin) or Plan(PlanOutcome.FOUND, np.empty((0, 2)))
    angles = np.linspace(-3.0, 3.0, 60)
    for _ in range(10):
        costmap.observe(Pose2D(3.0, 3.0), angles, np.full(60, 1.0), 6.0)
    planning.ask(costmap, START, GOAL)
    worker.until(lambda: len(twins) == 1)
    assert twins[0] is not costmap
    assert np.array_equal(twins[0].clearance, costmap.clearance)
    other = Costmap(room(4.0, 4.0))
    worker.until(lambda: planning._idle)
    planning.take_map(other)
    planning.ask(other, START, GOAL)
    worker.until(lambda: len(twins) == 2)
    assert twins[1].grid is other.grid


@pytest.mark.parametrize("fails", ["value", "exit"])
def test_what_a_planner_raises_is_raised_where_the_plan_is_waited_for(parts, fails):
    worker, planner, costmap, planning = parts
    planner.fails = fails
    planner.gate.set()
    planning.ask(costmap, START, GOAL)
    worker.until(lambda: planning._asked.future.done())
    with pytest.raises(Exception, match="lost"):
        planning.answer()
    planner.fails = ""
    planning.ask(costmap, START, GOAL)
    worker.until(lambda: planning._asked.future.done())
    assert planning.answer().outcome is PlanOutcome.FOUND


def test_preparing_goes_on_in_spare_time_and_may_fail(parts, monkeypatch):
    worker, planner, _, planning = parts
    planning.spare()
    assert planning._idle, "nothing is left to prepare"
    told = []
    monkeypatch.setattr(planning_thread.rospy, "logerr", lambda *words: told.append(words))
    planner.prepared, planner.fails = 0, "value"
    planning.take_map(Costmap(room()))
    worker.until(lambda: told and planning._idle)
    planning.spare()
    assert planner.prepared == 1


def test_what_takes_long_is_told(parts, monkeypatch):
    _, _, costmap, planning = parts
    told = []
    monkeypatch.setattr(planning_thread.rospy, "logwarn", lambda text, *values: told.append(text % values))
    planning.ask(costmap, START, GOAL)
    planning.tell()
    assert told == []
    for seconds, times in ((1.0, 0), (2.5, 1), (3.5, 1), (4.5, 2)):
        planning._running.begun = time.monotonic() - seconds
        planning.tell()
        assert len(told) == times
    assert "planning takes long: the robot's way is looked for since" in told[0]


# ---- commands that do not come -----------------------------------------------------------------------------------


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
        (0.3, 60.0, 0.0, False),  # simulated time stands
        (0.3, 60.0, -50.0, False),  # ... or went back
        (0.0, 60.0, 60.0, False),  # it stands anyway
    ],
)
def test_a_robot_without_its_next_command_is_stopped_once(watched, speed, wall, ros, stops):
    watch, sent, clock = watched
    watch.command(twist(speed))
    clock[0] += wall
    clock[1] += ros
    assert [watch.look(*clock), watch.look(*clock)] == [stops, False]
    assert [message.linear.x for message in sent] == [speed] + [0.0] * stops
    watch.command(twist(speed))
    assert not watch.look(*clock)
