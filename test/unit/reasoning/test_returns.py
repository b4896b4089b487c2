"""Returns and facts of interfaces at the limits of what the core accepts and remembers."""

import json

import pytest
from core_driver import Driver
from core_programs import BATTERY

from rosoclingo.oclingo import ReactiveProgram, parse_atom
from rosoclingo.reasoning.events import FactAccepted, Problem, ReturnAccepted
from rosoclingo.reasoning.input_feeder import Clock, InputFeeder
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.reasoning.observations import MEMORY, Observation
from rosoclingo.reasoning.returns import EXECUTED, ExecutionMonitor
from rosoclingo.reasoning.settings import CoreSettings

MOST_FACTS = 3


@pytest.fixture(autouse=True)
def few_facts(monkeypatch):
    """Limit facts per message to keep the tests quick."""
    monkeypatch.setattr("rosoclingo.reasoning.returns.MOST_FACTS", MOST_FACTS)


def test_returns_are_dated_with_present_cycle_and_interface():
    driver = Driver().goal("a", "do(walk,1)").goal("b", "do(run,2)").succeed()
    driver.facts("_seen(ball)", "garbage((", "_return(run,2,2)")
    driver.core.receive("door", [*["_seen(X)"] * MOST_FACTS, "_seen(ball)"])
    events = driver.journal.events
    assert [(type(one), one.cycle) for one in events if isinstance(one, (FactAccepted, ReturnAccepted))] == [
        (ReturnAccepted, 1),
        (FactAccepted, 2),
        (ReturnAccepted, 2),
    ]
    reported = [(one.origin, one.cycle) for one in driver.journal.of(Problem)]
    assert reported == [("interface", 2), *[("door", 3)] * (MOST_FACTS + 1)]


def test_returns_of_actions_that_time_out_are_reported_singly():
    driver = Driver(settings=CoreSettings(horizon_limit=8, action_timeout=0.5))
    driver.core.add_goal("a", "do(quick,1)")
    driver.goal("b", "do(quick,2)")
    driver.now += 0.5
    driver.run()
    assert [(one.origin, one.cycle) for one in driver.journal.of(Problem)] == [("quick", 1)] * 2
    assert driver.problems == [
        f"_action_lib(quick,{number},1) has not returned within 0.5 s: it counts as failed" for number in (1, 2)
    ]


@pytest.mark.parametrize(
    ("parameter", "value"), [("failed", "failed(failed)"), ("lost", "failed(lost)"), ("a", "lost")]
)
def test_returns_predict_failure_that_differs_from_success(parameter, value):
    monitor = monitor_of([])
    if value != "failed(failed)":
        monitor.begin(1, (action_of(parse_atom("_action_lib(go,b,1)")),), 0.0)
        monitor.receive("go", ["_return(go,lost,1)"])
        monitor.end_cycle()
    monitor.begin(2, (action_of(parse_atom(f"_action_lib(go,{parameter},2)")),), 1.0)
    ends = [monitor.likely_end(succeeds=one) for one in (True, False)]
    assert [str(answer) for _, answer in ends] == [f"_return(go,{parameter},2)", f"_return(go,{value},2)"]


def test_returns_limit_remembered_facts_with_a_cycle(monkeypatch):
    monkeypatch.setattr("rosoclingo.reasoning.returns.KNOWN", 2)
    driver = Driver(BATTERY).facts("_battery(high,7)", "_battery(high,8)").facts("_battery(high,7)", "_battery(high,8)")
    assert len(driver.journal.updates) == 1, "repeated facts are not new"
    driver.facts("_battery(high,9)").facts("_battery(high,8)")
    assert len(driver.journal.updates) == 2
    driver.facts("_battery(high,7)")
    assert driver.journal.updates[2] == "#step 3.\n_battery(high,7).\n#end step.\n", "the oldest was forgotten"


def test_returns_remember_executed_actions_after_facts_are_forgotten():
    program = ReactiveProgram.from_text("#external _return/3.")
    monitor = ExecutionMonitor(program, InputFeeder(), Clock(), lambda event: None, lambda: 1)
    actions = [action_of(parse_atom(f"_action_lib(go,a,{cycle})")) for cycle in range(1, EXECUTED + 3)]
    for action in actions:
        monitor.begin(action.cycle, (action,), 0.0)
        monitor.receive("go", [f"_return(go,lost,{action.cycle})"])
        assert monitor.end_cycle() == (action,)
    assert [one.cycle for one in monitor.observations] == list(range(EXECUTED + 3 - MEMORY, EXECUTED + 3))
    monitor.forget_all()
    assert not monitor.observations
    assert monitor.executed == tuple(actions[2:])


KEPT = "#external _return/3. #external _seen/1. #external _battery(X,t) : X = (low;high). #cumulative t. #volatile t."


def monitor_of(events):
    return ExecutionMonitor(ReactiveProgram.from_text(KEPT), InputFeeder(), Clock(), events.append, lambda: 2)


def test_returns_monitor_restores_its_state():
    events, more = [], []
    monitor, twin = monitor_of(events), monitor_of(more)
    (walk,) = actions = [action_of(parse_atom("_action_lib(walk,a,1)"))]
    monitor.begin(1, (walk,), 3.0)
    monitor.receive("walk", ["_return(walk,lost,1)"])
    monitor.end_cycle()
    names = ["walk,b", "walk,c", "walk,d", "run,a", "run,b"]
    actions = tuple(action_of(parse_atom(f"_action_lib({name},2)")) for name in names)
    monitor.begin(2, actions, 5.0)
    monitor.receive("legs", ["_return(walk,failed(c),2)", "_return(walk,lost,2)", "_return(run,b,2)"])
    monitor.receive("meter", ["_battery(low,2)"])
    record = json.loads(json.dumps(monitor.record()))
    twin.restore(record)
    assert twin.record() == record
    assert (twin.awaited, twin.under_way) == (monitor.awaited, actions)
    assert [str(one.atom) for one in twin.awaited] == ["_action_lib(walk,b,2)", "_action_lib(run,a,2)"]
    assert twin.executed == (walk,)
    assert twin.observations == monitor.observations
    assert monitor.observations
    twin.receive("legs", ["_battery(low,2)", "_return(run,b,2)", "_return(walk,c,2)"])
    assert ["has returned already" in one.message for one in more] == [True, True], "and known facts are not new"
    twin.expire(7.0, 3.0)
    assert len(more) == 2, "since 5.0"
    twin.expire(8.0, 3.0)
    assert twin.awaited == ()
    for one in (monitor, twin):
        one.expire(9.0, 3.0)
        assert one.end_cycle() == actions
    assert twin.observations == monitor.observations
    assert twin.executed == monitor.executed == (walk, *actions)


def test_returns_treat_unsent_facts_as_new_on_repeat():
    events = []
    monitor = monitor_of(events)
    low, high = parse_atom("_battery(low,2)"), parse_atom("_battery(high,2)")
    monitor.receive("meter", [str(low), str(high)])
    facts = [Observation(low, 2, original=low), Observation(high, 2)]
    ended = parse_atom("_return(walk,a,1)")
    monitor.update_accepted([*facts, Observation(ended, 1)], {low, ended})
    assert list(monitor.observations) == [facts[0]]
    monitor.receive("meter", [str(low), str(high)])
    assert [one.atom for one in events] == [low, high, high]
    monitor.forget_all()
    monitor.receive("meter", [str(low)])
    assert events[-1].atom == low
    monitor.update_accepted([Observation(high, 2, origin="meter", original=low, outdated=True)], ())
    assert events[-1].message == f"{low} from interface meter is too late: it is redated to {high}"
    monitor.receive("meter", [str(low)])
    assert events[-1].atom == low, "the report identifies it"


def test_returns_limit_queued_facts_by_text_length(monkeypatch):
    monkeypatch.setattr("rosoclingo.reasoning.returns.MOST_TEXT", 1000)
    driver = Driver().goal("a", "do(walk,1)")
    for number in range(4):
        driver.core.receive("eye", ["_seen({}{})".format("x" * 400, number)])
    assert [one.message.split(": ")[-1] for one in driver.journal.of(Problem)] == [
        "2 facts already wait for the next update"
    ] * 2
    driver.succeed()
    driver.core.receive("eye", ["_seen(y)"])
    assert len(driver.problems) == 2, "there is room again"
