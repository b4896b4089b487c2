"""The bench of many requests, with few requests and without OR-Tools."""

from argparse import Namespace

import comparison
import domains
import many_goals
import peers
import pytest
from acting_core import Robot
from deliveries import random_requests, row, task_of
from workloads import sized

OPTIONS = Namespace(action_time=0.01, limit=60.0, seed=1)


def task(offices, count, seed=1):
    floor = row(offices)
    return task_of(floor, random_requests(floor, count, seed))


@pytest.mark.slow
def test_many_goals_row_of_a_batch(monkeypatch):
    monkeypatch.setattr(peers, "folder_of", lambda package: None)
    monkeypatch.setattr(comparison.CoreParameters, "plan_time", 0.05)
    once = many_goals.measure_row("4", 3, "once", OPTIONS)
    assert once["first"] == once["all"] >= once["executed"] == 12
    assert once["wait"] == 0


@pytest.mark.slow
def test_many_goals_slow_plan_for_all_is_dropped():
    offices, goals, seconds = sized((6, 24, 0.1), (20, 40, 0.3))
    large = task(offices, goals)
    assert comparison.first_plan(large, limit=seconds) is None
    assert domains.improved_plans(large, seconds, 0.0) == {}
    assert comparison.execute(large, 0.0, 0.0, seconds) == {}
    _, first, waiting = comparison.first_plan(large, many_goals.TIMEOUT)
    assert first > 0
    assert 0 < waiting < goals


@pytest.mark.slow
def test_many_goals_improvement_ends_with_its_time():
    with Robot(task(8, 6)) as robot:
        robot.ask()
        steps = robot.plan()
        assert not list(robot.improve(0.0)), "no time is left for anything"
        assert robot.steps() == steps


@pytest.mark.slow
def test_many_goals_robot_pauses_only_between_planned_actions():
    with Robot(task(4, 2)) as robot:
        robot.ask([1])
        robot.plan()
        assert robot.still == 0.0, "no plan was in force before"
        robot.act(0.0)
        robot.plan()
        still = robot.still
        assert still > 0.0
        while robot.core.awaited:
            robot.act(0.0)
            still = robot.still
            robot.plan()
        robot.ask([2])
        robot.plan()
        assert robot.core.awaited
        assert robot.still == still, "the last plan was executed"


def test_many_goals_stream_adds_requests_during_actions_or_idling():
    arrivals = many_goals.Arrivals([1, 2, 3, 4], gap=2)
    assert arrivals.due(0, busy=False) == [1]
    assert arrivals.due(0, busy=False) == [2], "nothing else is to do"
    assert arrivals.due(1, busy=True) == []
    assert arrivals.due(4, busy=True) == [3]
    assert arrivals.due(6, busy=True) == [4]
    assert not arrivals


def test_many_goals_without_gap_all_come_at_once():
    assert many_goals.Arrivals([1, 2, 3, 4], gap=0).due(0, busy=True) == [1, 2, 3, 4]
