"""Returns and facts of interfaces at the limits of what the core accepts and remembers."""

from core_driver import Driver
from core_programs import BATTERY

from rosoclingo.reasoning.events import Problem


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
