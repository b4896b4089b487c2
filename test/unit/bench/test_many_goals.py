"""The bench of many requests, with few requests and without OR-Tools."""

import sys
from argparse import Namespace
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parents[3] / "bench"))

import many_goals  # noqa: E402
from deliveries import World, random_requests, row  # noqa: E402
from workloads import sized  # noqa: E402

OPTIONS = Namespace(
    seconds=[10],
    plan_time=5.0,
    action_time=0.01,
    search_timeout=10.0,
    all_seconds=60.0,
    gap=3,
    without_or_tools=True,
    without_fast_downward=True,
)


@pytest.mark.slow
@pytest.mark.once
def test_many_goals_rows_for_batch_and_stream():
    once = many_goals.measure("4", 3, "once", 1, OPTIONS)
    assert once["steps"] == once["all"] >= once["driven"] == 12
    assert once["10 s"] == 12
    assert once["wait"] == 0
    stream = many_goals.measure("4", 3, "stream", 1, OPTIONS)
    assert stream["driven"] >= 12


@pytest.mark.slow
@pytest.mark.once
def test_many_goals_slow_plan_for_all_is_dropped():
    offices, goals, seconds = sized((12, 24, 0.1), (20, 40, 0.3))
    floor, options = row(offices), Namespace(**{**vars(OPTIONS), "all_seconds": seconds})
    requests = random_requests(floor, goals, seed=1)
    assert many_goals.plan_for_all(floor, requests, options) == {"all [s]": None, "all": None}
    assert many_goals.plans_after(floor, requests, [seconds], plan_time=0.0) == {f"{seconds:g} s": None}
    first = many_goals.first_plan(floor, requests, options)
    assert first["steps"] > 0
    assert 0 < first["wait"] < goals


@pytest.mark.slow
@pytest.mark.once
def test_many_goals_improvement_ends_with_its_time():
    floor = row(8)
    with many_goals.Robot(floor, plan_time=0.0) as robot:
        robot.ask(random_requests(floor, 6, seed=1))
        steps = robot.plan()
        assert not list(robot.improve(0.0)), "no time is left for anything"
        assert robot.steps() == steps


@pytest.mark.slow
@pytest.mark.once
def test_many_goals_robot_pauses_only_between_planned_actions():
    floor = row(4)
    first, second = random_requests(floor, 2, seed=1)
    with many_goals.Robot(floor, plan_time=0.0) as robot:
        robot.ask([first])
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
        robot.ask([second])
        robot.plan()
        assert robot.core.awaited
        assert robot.still == still, "the last plan was executed"


def test_many_goals_stream_adds_requests_during_actions_or_idling():
    requests, world = random_requests(row(4), 4, seed=1), World(row(4))
    arrivals = many_goals.Arrivals(requests, gap=2)
    assert arrivals.due(world) == requests[:1]
    assert arrivals.due(world) == requests[1:2], "nothing else is to do"
    world.ask(requests[:2])
    assert arrivals.due(world) == []
    world.actions = 4
    assert arrivals.due(world) == requests[2:3]
    world.actions = 6
    assert arrivals.due(world) == requests[3:]
    assert not arrivals


def test_many_goals_without_gap_all_come_at_once():
    requests = random_requests(row(4), 4, seed=1)
    assert many_goals.Arrivals(requests, gap=0).due(World(row(4))) == requests
