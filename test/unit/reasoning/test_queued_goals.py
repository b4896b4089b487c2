"""Goals beyond the capacity are queued: a long search aborts none, and newer goals do not starve older ones."""

from random import Random

import pytest
from busy_driver import BusyDriver
from core_scripts import play, scripts
from hypothesis import settings
from test_admission import numbers_of

from rosoclingo.reasoning.admission import SHARE
from rosoclingo.reasoning.events import GoalChanged
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.settings import CoreSettings

pytestmark = pytest.mark.once

MANY = min(1000, 2 * settings.default.max_examples)  # goals in a long run


def ask(driver, *numbers, what="walk"):
    for number in numbers:
        driver.core.add_goal(f"g{number}", f"do({what},{number})")
    return driver


def ends(driver):
    return {one.key: one.outcome for one in driver.journal.of(GoalChanged) if one.outcome is not None}


class Errands(BusyDriver):
    """The words of scripts about goals by their numbers."""

    def ask(self, goals, what="walk"):
        """Send goals such as 3-5 with the next event."""
        ask(self, *numbers_of([goals]), what=what)

    def most_goals(self, number):
        """Set the number of goals for which planning has time."""
        self.most = int(number)

    def deferred(self, *goals):
        """Expect these goals to be queued."""
        assert [one.key for one in self.core.queue.waiting] == [f"g{number}" for number in numbers_of(goals)]

    def reason(self, number, *words):
        """Expect that a client received once the reason why its goal is queued, or never."""
        assert self.waits(f"g{number}") == ([" ".join(words)] if words else [])

    def withdraws(self, number, cycle):
        """Expect that a request was in force and is withdrawn."""
        assert f"#withdraw _request(do(walk,{number}),{cycle})." in self.journal.stream

    def all_met(self, *goals):
        """Finish everything; expect exactly these goals to be met, in this order."""
        assert self.finish().order() == [f"g{number}" for number in numbers_of(goals)]
        assert set(ends(self).values()) == {Outcome.SUCCEEDED}


WHY = "goals were too many: no plan was found before the search was ended: the test"

#: The initial number of goals for which planning has time, and the script.
BUSY = {
    "newest goals wait, which is reported once": (3, f"""
        ask 1-8; run; deferred 3-8; reason 8 8 {WHY}; reason 3 4 {WHY}; reason 2; withdraws 3 2
        unsent ...do(walk,5)...; problem no plan was found before the search was ended: the test: 4 of 8 goals wait
        all_met 1-8; reason 8 8 {WHY}"""),
    "goal that was active stays so while it waits and is cancelled at once": (4, """
        ask 1-4; run; succeed; all g4 active; most_goals 1; fail failed; does walk,2,...; all g4 active; withdraws 4 2
        cancel g4; all g4 active preempting preempted; finish; is g1 succeeded; is g2 succeeded; is g3 succeeded"""),
    "impossible goal ends with its proof though other searches are cut": (2, """
        ask 1-2; ask 3 never; ask 4-5; run; finish; is g3 aborted; is g1 succeeded; is g2 succeeded; is g4 succeeded
        is g5 succeeded; says g3 do(never,3) cannot be met: there is no plan of at most..."""),
}  # fmt: skip


@scripts(BUSY)
def test_queued_goals_of_busy_core_follow_script(row):
    most, script = row
    play(Errands(most=most), script)


@pytest.mark.slow
def test_queued_goals_are_admitted_up_to_planning_capacity():
    """So nothing has to be undone: no search is cut, and no goal is withdrawn."""
    driver = ask(BusyDriver(most=99, plan_time=0.0), *range(1, 40))
    driver.seconds = lambda goals: SHARE * CoreSettings.search_timeout * (goals / 12) ** 2
    driver.run().finish()
    assert len(ends(driver)) == 39
    assert max(driver.searches) == 12
    assert "#withdraw" not in driver.journal.stream
    joins = [update for update in driver.journal.updates if "_request(do(" in update]
    assert len(joins) < 10, "they join together"


@pytest.mark.slow
def test_far_goal_is_overtaken_only_for_limited_time():
    """The far errand would end last; each completed one is replaced."""
    limit = 3
    settings = CoreSettings(horizon_limit=40, overtaking_limit=limit)
    driver = BusyDriver(settings=settings, most=99, plan_time=0.0)
    driver.core.add_goal("far", "do(far,0)")
    for near in range(1, 31):
        ask(driver, near)
        if near > 1:
            driver.run().succeed()
    order = driver.order()
    assert "far" in order
    assert limit <= order.index("far") <= limit + 1, "those that were with the program by then"
    waited = [near for near in range(1, 31) if driver.waits(f"g{near}") == ["do(far,0) has priority"]]
    assert waited
    assert order.index("far") < min(order.index(f"g{near}") for near in waited if f"g{near}" in order)
    driver.finish()
    assert set(ends(driver).values()) == {Outcome.SUCCEEDED}


@pytest.mark.slow
def test_many_goals_with_failures_and_interrupted_searches_end():
    """Failed actions are tried again and goals beyond the capacity wait; only impossible goals are aborted."""
    driver, draw, asked, hopeless = BusyDriver(most=5, chance=0.1, plan_time=0.0), Random(7), 0, set()
    for _ in range(20_000):
        while asked < MANY and len(driver.core.live_goals) < 20:
            for _ in range(draw.choice([1, 1, 1, 10])):
                asked += 1
                hopeless |= {f"g{asked}"} if draw.random() < 0.1 else set()
                ask(driver, asked, what="never" if f"g{asked}" in hopeless else "walk")
        driver.run()
        if not driver.core.awaited:
            break
        driver.fail("failed") if draw.random() < 0.1 else driver.succeed()
    found = ends(driver)
    assert len(found) == asked
    assert {key for key, outcome in found.items() if outcome is not Outcome.SUCCEEDED} == hopeless
    assert hopeless
    assert driver.core.live_goals == []
    assert max(driver.searches) > 5
