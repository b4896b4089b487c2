"""Improved plans are sent out while actions run; an arrival ends the search for them."""

import pytest
from core_driver import Driver, first

from rosoclingo.reasoning.events import GoalProgress, PlanMade

pytestmark = pytest.mark.once

#: A goal do(N,Id) takes the actions do(1) to do(N) in order; all except the first are deferred for no reason.
SLOW = """
#external _request/2. #external _return/3.
#program cumulative(t).
todo(N,t) :- _request(do(N,I),t+1).
todo(N,t) :- todo(N,t-1).
begun(t) :- todo(N,t).
done(0,t) :- begun(t), not begun(t-1).
done(M,t) :- done(M,t-1), not _action_lib(do,M+1,t).
{ _action_lib(do,M+1,t) } :- done(M,t-1), todo(N,t), M < N.
done(M,t) :- _action_lib(do,M,t).
#heuristic _action_lib(do,1,t) : done(0,t-1). [9,true]
#heuristic _action_lib(do,M,t) : done(M-1,t-1), M = 2..9. [9,false]
#program volatile(t).
:- todo(N,t), not done(N,t).
#program base.
#show _action_lib/3.
"""


@pytest.fixture
def driver():
    """Return a core whose first action is under way, with a plan that is not the shortest."""
    one = Driver(SLOW, solver=first).goal("a", "do(4,1)")
    assert len(one.core.awaited) == 1
    return one


def rest(driver):
    """Return the actions that are planned for later, with their cycles counted from the present one."""
    return [
        (str(one.parameter), one.cycle - driver.core.cycle) for one in driver.core.plan.remaining(driver.core.cycle + 1)
    ]


def improve(driver):
    while driver.core.improve(lambda: False):
        pass


def test_core_reports_and_sends_an_improved_plan(driver):
    assert rest(driver) != [("2", 1), ("3", 2), ("4", 3)]
    running, plans, progress = driver.awaited, len(driver.journal.of(PlanMade)), len(driver.feedback("a"))
    improve(driver)
    assert driver.awaited == running
    assert rest(driver) == [("2", 1), ("3", 2), ("4", 3)]
    published = driver.journal.of(PlanMade)[plans:]
    assert published[-1].actions == driver.core.plan.remaining(driver.core.cycle)
    assert [one.actions for one in driver.feedback("a")[progress:]] == [one.actions for one in published]
    assert isinstance(driver.feedback("a")[-1], GoalProgress)
    first = driver.core.cycle
    driver.finish()
    assert driver.core.cycle == first + 4
    assert driver.states("a")[-1] == "succeeded"


def test_core_stops_improving_on_arrival_and_resumes_later(driver):
    plan = driver.core.plan
    assert driver.core.improve(lambda: True)
    assert driver.core.plan == plan
    driver.core.add_goal("b", "do(2,2)")
    assert not driver.core.improve(lambda: False), "the goal waits for the next cycle"
    driver.succeed()
    assert driver.core.improve(lambda: True)
