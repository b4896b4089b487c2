from pathlib import Path

import pytest

from rosoclingo.runs.scenario import Scenario, ScenarioError

SHIPPED = sorted((Path(__file__).resolve().parents[3] / "config" / "scenarios").glob("*.yaml"))


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_scenarios_can_be_read(path):
    scenario = Scenario.from_file(path)
    assert scenario.title
    requests = [event for event in scenario.events if event.verb == "request"]
    assert len(scenario.expect["goals"]) == len(requests)


def test_everything_a_scenario_may_hold():
    scenario = Scenario.from_text("""
title: All
packages: {1: office3}
timeout: 100
events:
  - {time: 1.5, request: "g(1)"}
  - {cycle: 2, delay: 3, cancel: 1, client: other}
  - {cycle: 3, facts: ["_seen(ball)"], origin: camera}
  - {cycle: 4, call: simulator/set_door, with: {door: east, open: false}}
launch: house
expect: {goals: [canceled], packages: {1: office3}, robot: office2, actions: []}
""")
    first, second, third, fourth = scenario.events
    assert (first.verb, first.value, first.time, first.cycle, first.client) == ("request", "g(1)", 1.5, None, "client")
    assert (second.verb, second.value, second.time, second.cycle, second.client) == ("cancel", 1, 3.0, 2, "other")
    assert (third.value, third.origin) == (["_seen(ball)"], "camera")
    assert (fourth.verb, fourth.value) == ("call", "simulator/set_door")
    assert fourth.fields == {"door": "east", "open": False}
    assert scenario.launch == "house"
    assert scenario.packages == {"1": "office3"}
    assert scenario.expect["packages"] == {"1": "office3"}
    assert scenario.timeout == 100.0
    assert [str(event) for event in scenario.events][:2] == ["at 1.5 s request g(1)", "in cycle 2 cancel 1"]


def test_when_events_are_due():
    timed, cycled = Scenario.from_text("events: [{time: 2, cancel: 1}, {cycle: 3, delay: 1, cancel: 1}]").events
    assert not timed.due(1.9, {})
    assert timed.due(2.0, {})
    assert not cycled.due(50.0, {1: 0.0, 2: 1.0})
    assert not cycled.due(10.5, {1: 0.0, 4: 10.0})
    assert cycled.due(11.0, {1: 0.0, 4: 10.0, 5: 10.9})


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "the scenario: give a map"),
        ("[", "no YAML"),
        ("events: 3", "events: give a list"),
        ("title: x", "events: give a list"),
        ("events: []\nevnts: []", "'evnts' is none of"),
        ("events: [3]", "event 1: give a map"),
        ("events: [{time: 1}]", "event 1: give one of request, cancel, facts, call"),
        ("events: [{time: 1, request: a, cancel: 1}]", "give one of"),
        ("events: [{request: g(1)}]", "either 'time' or 'cycle'"),
        ("events: [{time: 1, cycle: 1, request: g(1)}]", "either 'time' or 'cycle'"),
        ("events: [{time: -1, request: g(1)}]", "no number of seconds"),
        ("events: [{time: soon, request: g(1)}]", "no number of seconds"),
        ("events: [{cycle: 0, request: g(1)}]", "is no cycle"),
        ("events: [{cycle: x, request: g(1)}]", "is no cycle"),
        ("events: [{time: 1, request: 3}]", "nothing to request"),
        ("events: [{time: 1, facts: a}]", "nothing to facts"),
        ("events: [{time: 1, call: 3}]", "nothing to call"),
        ("events: [{time: 1, call: a, with: 3}]", "event 1: with: give a map"),
        ("events: [{time: 1, request: a, with: {b: 1}}]", "event 1: 'with' goes with 'call' alone"),
        ("events: []\nexpect: {goals: [preempted]}", "preempted is none of"),
        ("events: []\nexpect: {goal: []}", "'goal' is none of"),
        ("events: []\npackages: [1]", "packages: give a map"),
        ("events: []\ntimeout: long", "timeout: 'long' is no number"),
    ],
)
def test_faults_name_their_place(text, fault):
    with pytest.raises(ScenarioError) as error:
        Scenario.from_text(text)
    assert fault in str(error.value)


def test_missing_file_is_named():
    with pytest.raises(ScenarioError, match="nowhere"):
        Scenario.from_file(Path("/nowhere.yaml"))


def test_what_need_not_be_said():
    scenario = Scenario.from_text('events: [{cycle: 1, request: "g(1)"}]\nexpect: {robot: office2}')
    (event,) = scenario.events
    assert (event.cycle, event.time) == (1, 0.0), "as soon as the plan of cycle 1 is out"
    assert event.due(0.5, {1: 0.5})
    assert scenario.expect == {"robot": "office2"}, "of packages nothing is expected"


def test_yes_is_no_number_of_seconds():
    with pytest.raises(ScenarioError, match="True is no number of seconds"):
        Scenario.from_text('events: [{time: yes, request: "g(1)"}]')
