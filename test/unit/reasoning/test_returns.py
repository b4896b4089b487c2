"""Returns and facts of interfaces at the limits of what the core accepts and remembers."""

import pytest
from core_driver import Driver
from core_programs import BATTERY

from rosoclingo.reasoning.events import Problem, ReturnAccepted

MOST_FACTS = 3


@pytest.fixture(autouse=True)
def few_facts(monkeypatch):
    """Limit facts per message to keep the tests quick."""
    monkeypatch.setattr("rosoclingo.reasoning.returns.MOST_FACTS", MOST_FACTS)


def test_returns_are_dated_with_present_cycle_and_interface():
    driver = Driver().goal("a", "do(walk,1)").goal("b", "do(run,2)").succeed()
    driver.facts("_seen(ball)", "garbage((", "_return(run,2,2)")
    driver.core.receive("door", [*["_seen(X)"] * MOST_FACTS, "_seen(ball)"])
    assert [one.cycle for one in driver.journal.of(ReturnAccepted)] == [1, 2]
    assert any("_seen(ball)" in one for one in driver.journal.updates)
    reported = [(one.origin, one.cycle) for one in driver.journal.of(Problem)]
    assert reported == [("interface", 2), *[("door", 3)] * (MOST_FACTS + 1)]


def test_returns_limit_remembered_facts_with_a_cycle(monkeypatch):
    monkeypatch.setattr("rosoclingo.reasoning.returns.KNOWN", 2)
    driver = Driver(BATTERY).facts("_battery(high,7)", "_battery(high,8)").facts("_battery(high,7)", "_battery(high,8)")
    assert len(driver.journal.updates) == 1, "repeated facts are not new"
    driver.facts("_battery(high,9)").facts("_battery(high,8)")
    assert len(driver.journal.updates) == 2
    driver.facts("_battery(high,7)")
    assert driver.journal.updates[2] == "#step 3.\n_battery(high,7).\n#end step.\n", "the oldest was forgotten"


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
