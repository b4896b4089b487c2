from pathlib import Path

import pytest
import yaml

from rosoclingo.common.reading import Reader
from rosoclingo.runs.scenario import Scenario, ScenarioError

SHIPPED = sorted((Path(__file__).resolve().parents[3] / "config" / "scenarios").glob("*.yaml"))


def read(text):
    return Scenario.read(Reader(yaml.safe_load(text)))


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_scenario_files_that_are_shipped_can_be_read(path):
    scenario = Scenario.from_file(path)
    assert scenario.title
    requests = [event for event in scenario.events if event.verb == "request"]
    assert len(scenario.expect["goals"]) == len(requests)


def test_scenario_reads_every_permitted_key():
    scenario = read("""
title: All
packages: {1: office3}
timeout: 100
events:
  - {time: 1.5, request: "g(1)"}
  - {cycle: 2, delay: 3, cancel: 1, client: other}
  - {cycle: 3, facts: ["_seen(ball)"], origin: camera}
  - {cycle: 4, call: simulator/set_door, with: {door: east, open: false}}
launch: house
expect: {goals: [canceled], packages: {1: office3}, robot: office2, actions: ["_action_lib(go,x,1)"]}
""")
    first, second, third, fourth = scenario.events
    assert (first.verb, first.value, first.time, first.cycle, first.client) == ("request", "g(1)", 1.5, None, "client")
    assert (second.verb, second.value, second.time, second.cycle, second.client) == ("cancel", 1, 3.0, 2, "other")
    assert (third.value, third.origin) == (["_seen(ball)"], "camera")
    assert (fourth.verb, fourth.value) == ("call", "simulator/set_door")
    assert fourth.fields == {"door": "east", "open": False}
    assert scenario.launch == "house"
    assert scenario.packages == {"1": "office3"}
    assert scenario.expect == {
        "goals": ["canceled"],
        "packages": {"1": "office3"},
        "robot": "office2",
        "actions": ["_action_lib(go,x,1)"],
    }
    assert scenario.timeout == 100.0
    assert [str(event) for event in scenario.events][:2] == ["at 1.5 s request g(1)", "in cycle 2 cancel 1"]


def test_scenario_events_have_due_times():
    timed, cycled = read("events: [{time: 2, cancel: 1}, {cycle: 3, delay: 1, cancel: 1}]").events
    assert not timed.due(1.9, {})
    assert timed.due(2.0, {})
    assert not cycled.due(50.0, {1: 0.0, 2: 1.0})
    assert not cycled.due(10.5, {1: 0.0, 4: 10.0})
    assert cycled.due(11.0, {1: 0.0, 4: 10.0, 5: 10.9})


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "events: is missing: give a list of events"),
        ("3", "must be a mapping with the keys title, events, packages, expect, timeout, launch, servers, not 3"),
        ("events: []\nevnts: []", "unknown key 'evnts' (did you mean events?); keys are title, events"),
        ("events: [{request: g(1)}]", "either 'time' or 'cycle'"),
        ("events: [{time: -1, request: g(1)}]", "events[0].time: must be a number of seconds, at least 0, not -1"),
        ("events: [{time: 1, call: a, with: 3}]", "events[0].with: must be a mapping of the request's fields, not 3"),
        ("events: [{time: 1, request: a, with: {b: 1}}]", "events[0].with: is only for 'call'"),
        ("events: [{time: 1, delay: 1, cancel: 1}]", "events[0].delay: is only for events with a 'cycle'"),
        ("events: [{cycle: 0, cancel: 1}]", "events[0].cycle: must be an integer of at least 1, not 0"),
        ("events: [{time: 1, requst: g(1)}]", "events[0]: unknown key 'requst' (did you mean request?)"),
        ("events: [{time: 1}]", "events[0]: give one of request, cancel, facts, call"),
        (
            "events: []\nexpect: {goals: [won]}",
            "expect.goals[0]: must be one of succeeded, canceled, rejected, aborted",
        ),
        ("events: []\nexpect: {goal: []}", "expect: unknown key 'goal' (did you mean goals?); keys are goals"),
    ],
)
def test_scenario_faults_name_their_place(text, fault):
    with pytest.raises(ScenarioError) as error:
        read(text)
    assert fault in str(error.value)


def test_scenario_file_that_cannot_be_read_is_named(tmp_path):
    broken = tmp_path / "broken.yaml"
    broken.write_text("[")
    for path in (Path("/nowhere.yaml"), broken):
        with pytest.raises(ScenarioError, match=path.stem):
            Scenario.from_file(path)
