"""What interfaces tell the core, at the limits of what it takes and remembers."""

import pytest
from core_driver import Driver
from test_late_facts import BATTERY

from rosoclingo.oclingo import ReactiveProgram, parse_atom
from rosoclingo.reasoning import CoreSettings, FactTaken, Problem, ReturnTaken
from rosoclingo.reasoning.input_feeder import Clock, InputFeeder
from rosoclingo.reasoning.keywords import LONGEST, action_of
from rosoclingo.reasoning.returns import EXECUTED, ExecutionMonitor

MOST_FACTS = 3


@pytest.fixture(autouse=True)
def few_facts(monkeypatch):
    """Messages have few facts, to be quick."""
    monkeypatch.setattr("rosoclingo.reasoning.returns.MOST_FACTS", MOST_FACTS)


def test_as_many_facts_as_a_message_may_have():
    driver = Driver().facts(*(f"_seen({number})" for number in range(MOST_FACTS)))
    assert driver.problems == []
    assert f"_seen({MOST_FACTS - 1})." in driver.journal.updates[0]


def test_a_fact_as_long_as_it_may_be():
    fact = '_seen("{}")'.format("x" * (LONGEST - len('_seen("")')))
    driver = Driver().facts(fact)
    assert driver.problems == []
    assert fact in driver.journal.updates[0]


def test_what_is_told_has_the_present_cycle_and_its_interface():
    driver = Driver().goal("a", "do(walk,1)").goal("b", "do(run,2)").succeed()
    driver.facts("_seen(ball)", "garbage((", "_return(run,2,2)")
    driver.core.receive("door", [*["_seen(X)"] * MOST_FACTS, "_seen(ball)"])
    events = driver.journal.events
    assert [(type(one), one.cycle) for one in events if isinstance(one, (FactTaken, ReturnTaken))] == [
        (ReturnTaken, 1),
        (FactTaken, 2),
        (ReturnTaken, 2),
    ]
    told = [(one.origin, one.cycle) for one in driver.journal.of(Problem)]
    assert told == [("interface", 2), *[("door", 3)] * (MOST_FACTS + 1)]


def test_actions_that_time_out_are_told_one_by_one():
    driver = Driver(settings=CoreSettings(horizon_limit=8, action_timeout=0.5))
    driver.core.add_goal("a", "do(quick,1)")
    driver.goal("b", "do(quick,2)")
    driver.now += 0.5
    driver.run()
    assert [(one.origin, one.cycle) for one in driver.journal.of(Problem)] == [("quick", 1)] * 2
    assert driver.problems == [
        f"_action_lib(quick,{number},1) has not returned within 0.5 s: it counts as failed" for number in (1, 2)
    ]


def test_so_many_facts_that_name_their_cycle_are_remembered(monkeypatch):
    monkeypatch.setattr("rosoclingo.reasoning.returns.KNOWN", 2)
    driver = Driver(BATTERY).facts("_battery(high,7)", "_battery(high,8)").facts("_battery(high,7)", "_battery(high,8)")
    assert len(driver.journal.updates) == 1, "told again they are nothing new"
    driver.facts("_battery(high,9)").facts("_battery(high,8)")
    assert len(driver.journal.updates) == 2
    driver.facts("_battery(high,7)")
    assert driver.journal.updates[2] == "#step 3.\n_battery(high,7).\n#end step.\n", "the oldest was forgotten"


def test_what_was_done_was_done_though_all_that_was_told_is_forgotten():
    program = ReactiveProgram.from_text("#external _return/3.")
    monitor = ExecutionMonitor(program, InputFeeder(), Clock(), lambda event: None, lambda: 1)
    actions = [action_of(parse_atom(f"_action_lib(go,a,{cycle})")) for cycle in range(1, EXECUTED + 3)]
    for action in actions:
        monitor.begin(action.cycle, (action,), 0.0)
        monitor.receive("go", [f"_return(go,lost,{action.cycle})"])
        assert monitor.end_cycle() == (action,)
    assert monitor.observations.newest_first
    monitor.forget_all()
    assert monitor.observations.newest_first == ()
    assert monitor.executed == tuple(actions[2:])
