"""Facts that come late, early, twice or are false: none leaves the program without an answer or ends a goal."""

from pathlib import Path

import pytest
from core_driver import ERRANDS, Driver
from workloads import sized

ROOT = Path(__file__).resolve().parents[3]
BATTERY = (ROOT / "test" / "data" / "battery.lp").read_text() + "#program cumulative(t).\n"

#: A door seen shut in a cycle can't have been gone through in the next.
DOORS = """
#external _request/2. #external _return/3. #external _shut/2.
#program base.
room(hall). room(den). door(hall,den). door(den,hall). at(hall,0).
#program cumulative(t).
wanted(R,I,t) :- _request(go(R,I),t+1).
wanted(R,I,t) :- wanted(R,I,t-1), not at(R,t-1), not _request(cancel(I),t).
{ _action_lib(go,R,t) : door(Q,R), at(Q,t-1) } 1 :- wanted(_,_,t).
at(R,t) :- _action_lib(go,R,t), not failed(t).
at(R,t) :- at(R,t-1), not moved(t).
moved(t) :- _action_lib(go,R,t), not failed(t).
failed(t) :- _return(go,V,t), not room(V).
:- _action_lib(go,R,t), _shut(R,t-1).
#program volatile(t).
:- wanted(R,I,t), not at(R,t).
#program base.
#show _action_lib/3.
"""


def problems(driver, word):
    return [text for text in driver.journal.problems if word in text]


def test_a_fact_of_now_has_the_cycle_of_the_next_action():
    driver = Driver(BATTERY).facts("_battery(low,now)")
    assert driver.journal.updates == ["#step 1.\n_battery(low,1).\n#end step.\n"]
    driver.goal("a", "do(walk,1)")
    assert driver.awaited == ["_action_lib(walk,1,2)"]
    driver.facts("_battery(low,now)", "_return(walk,1,2)").goal("b", "do(run,2)")
    assert "_battery(low,3)." in driver.journal.updates[2]
    assert driver.awaited == ["_action_lib(run,2,4)"], "cycle 3 heeded it"
    assert driver.finish().states("b")[-1] == "succeeded"


def test_a_fact_of_now_has_the_cycle_just_over_where_it_counts_from_the_next_one_on():
    driver = Driver(DOORS).goal("a", "go(den,1)").finish()
    driver.core.receive("door", ["_shut(hall,now)"])
    driver.goal("b", "go(hall,2)")
    assert "_shut(hall,2)." in driver.journal.updates[-2]
    assert driver.awaited == ["_action_lib(go,hall,4)"], "not in cycle 3, after it was seen shut"
    assert driver.finish().states("b")[-1] == "succeeded"


def test_a_fact_of_now_before_the_first_cycle_comes_before_the_requests():
    driver = Driver(DOORS)
    driver.core.receive("door", ["_shut(den,now)"])
    driver.goal("a", "go(den,1)")
    assert driver.journal.updates[0] == "#step 1.\n_shut(den,1).\n#end step.\n"
    assert driver.awaited == ["_action_lib(go,den,3)"]
    assert driver.finish().states("a")[-1] == "succeeded"


def test_a_late_fact_is_taken_for_the_present():
    driver = Driver(DOORS).goal("a", "go(den,1)").finish()
    driver.core.receive("door", ["_shut(den,0)"])
    driver.goal("b", "go(hall,2)").finish()
    assert driver.states("b")[-1] == "succeeded"
    told = "_shut(den,0) from interface door contradicts that go(den) was done in cycle 1: taken for cycle 2"
    assert driver.journal.problems == [told]
    assert not any("_shut(den,0)" in text for text in driver.journal.updates), "what was withheld is not told"
    assert any("_shut(den,2)" in text for text in driver.journal.updates)


def test_a_late_fact_that_was_taken_for_the_present_may_be_a_reason():
    rule = "#external _storm/1.\n#program cumulative(t).\n:- _action_lib(walk,_,t), _storm(C), C <= t.\n"
    driver = Driver(ERRANDS + rule).goal("a", "do(walk,1)").finish().facts("_storm(1)")
    assert driver.journal.problems == [
        "_storm(1) from interface interface contradicts what was done and told before: taken for cycle 3"
    ]
    driver.goal("b", "do(walk,2)")
    assert driver.message("b") == "do(walk,2) cannot be met since _storm(3) was told in cycle 2"


def test_a_fact_of_a_cycle_to_come_that_bites_when_it_has_come():
    text = BATTERY + "#external _must/1.\n:- _must(t), not _action_lib(rest,9,t).\n"
    driver = Driver(text).goal("r", "do(rest,9)").facts("_must(4)")
    for _ in range(3):
        driver.facts(f"_return(rest,failed,{driver.core.cycle})")
    assert driver.finish().states("r")[-1] == "succeeded"
    assert driver.goal("b", "do(run,2)").finish().states("b")[-1] == "succeeded"


def test_a_request_that_contradicts_the_past():
    driver = Driver(BATTERY + ":- _request(do(jump,I),t+1), _action_lib(walk,J,t-2).\n")
    driver.goal("a", "do(walk,1)").finish().goal("b", "do(jump,2)")
    assert driver.states("b")[-1] == "aborted"
    assert "#withdraw _request(do(jump,2),4)." in driver.journal.updates[-1]
    assert driver.goal("c", "do(run,3)").finish().states("c")[-1] == "succeeded"


def test_a_cancel_that_contradicts_the_past():
    driver = Driver(BATTERY + ":- _request(cancel(I),t), _action_lib(W,I,t-1).\n")
    driver.goal("a", "do(walk,1)").cancel("a").facts("_return(walk,failed,1)").finish()
    assert driver.core.live_goals == []
    assert driver.goal("c", "do(run,3)").finish().states("c")[-1] == "succeeded"


@pytest.mark.slow
@pytest.mark.once
def test_facts_of_cycles_long_over_are_taken_for_the_present():
    goals = sized(60, 130)
    now = 2 * goals + 1
    driver = Driver(BATTERY)
    for number in range(goals):
        driver.goal(str(number), f"do(walk,{number})").finish()
    driver.core.receive("power", ["_battery(low,3)", "_battery(low,4)"])
    driver.goal("b", "do(run,200)")
    assert f"_battery(low,{now})." in driver.journal.updates[-2]
    assert driver.awaited == [f"_action_lib(run,200,{now + 1})"]
    assert (
        driver.journal.problems[0]
        == f"_battery(low,3) from interface power comes too late: it is taken as _battery(low,{now})"
    )
    assert driver.finish().states("b")[-1] == "succeeded"


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("fact", ["_blocked(office1,office2,6)", "_blocked(office1,office2,7)"])
def test_a_fact_of_a_cycle_to_come_that_leaves_nothing_to_do_ends_a_cancelled_goal(fact):
    """Nothing is done meanwhile, but the answer ends later than now: its end is waited for."""
    driver = Driver.of_shipped("mailbot.lp", "office.lp").goal("key", "goal(office3,office1,1)").until("pickup")
    driver.succeed().succeed()
    assert driver.awaited == ["_action_lib(move_base,office1,5)"]
    driver.core.cancel_goal("key")
    driver.core.receive("door", [fact])
    driver.succeed().finish()
    assert driver.states("key")[-1] == "preempted"
    assert driver.core.live_goals == []
