"""What the core does when the solver finds no plan: it ends goals with the reason, as few as possible, and goes on."""

import pytest
from core_driver import ERRANDS, Driver

#: ``lock`` and ``open`` exclude each other.
EXCLUSIVE = (
    ERRANDS
    + """
#program volatile(t).
:- asked(lock,I,_), asked(open,J,_), not done_or_dropped(I), not done_or_dropped(J).
#program base.
done_or_dropped(I) :- _request(cancel(I),_).
"""
)

#: Cancelling is not understood.
STUBBORN = ERRANDS.replace("done(I,t) :- _request(cancel(I),t).", "")


def test_goal_that_cannot_be_met_is_aborted_with_the_reason():
    driver = Driver().goal("a", "do(never,1)")
    assert driver.states("a") == ["active", "aborted"]
    assert driver.message("a") == "do(never,1) cannot be met: there is no plan of at most 8 steps"
    assert "_request(cancel(1),2)." in driver.journal.updates[1]
    assert driver.goal("b", "do(walk,2)").finish().states("b")[-1] == "succeeded"


def test_only_the_goal_at_fault_ends():
    driver = Driver()
    driver.core.add_goal("a", "do(walk,1)")
    driver.core.add_goal("bad", "do(never,2)")
    driver.core.add_goal("c", "do(run,3)")
    driver.run().finish()
    assert driver.states("bad")[-1] == "aborted"
    assert driver.states("a")[-1] == driver.states("c")[-1] == "succeeded"


@pytest.mark.slow
def test_what_is_said_of_a_goal_in_the_cycle_in_which_another_cannot_be_met_is_heard():
    driver = Driver.of_shipped("mailbot.lp", "office.lp").goal("a", "goal(office2,office2,3)")
    driver.facts("_blocked(office1,office2,now)")
    driver.core.add_goal("bad", "goal(office1,7,6)")
    driver.goal("far", "goal(office1,office2,7)").fail("failed")
    assert driver.states("far")[-1] == "aborted"
    assert driver.message("bad") == "the program rejects goal(office1,7,6): there is no place 7"


@pytest.mark.slow
def test_a_rejection_that_nobody_heard_is_not_taken_for_the_end_of_an_older_goal_with_its_id():
    driver = Driver.of_shipped("mailbot.lp", "office.lp").goal("old", "goal(office3,office1,6)")
    driver.until("pickup").succeed().facts("_blocked(office1,office2,now)")
    driver.core.add_goal("other", "goal(office1,office1,1)")
    driver.succeed()
    assert driver.states("old")[-1] == "aborted"  # and package 6 goes back to office3
    assert driver.awaited
    driver.facts("_blocked(office1,office2,now)")
    driver.core.add_goal("bad", "goal(office3,7,6)")
    driver.goal("far", "goal(office1,office2,7)").finish()
    assert driver.states("far")[-1] == "aborted"
    assert driver.message("bad") == "the program rejects goal(office3,7,6): there is no place 7"


def test_newer_goal_gives_way():
    driver = Driver(EXCLUSIVE).goal("a", "do(walk,1)").goal("b", "do(open,2)").goal("c", "do(lock,3)").finish()
    assert driver.states("c")[-1] == "aborted"
    assert driver.states("a")[-1] == driver.states("b")[-1] == "succeeded"


def test_program_that_does_not_understand_cancelling():
    driver = Driver(STUBBORN).goal("a", "do(never,1)")
    assert driver.states("a")[-1] == "aborted"
    assert any("cancelling did not help" in problem for problem in driver.journal.problems)
    assert driver.goal("b", "do(walk,2)").finish().states("b")[-1] == "succeeded"


def test_program_without_any_answer_ends_every_goal():
    driver = Driver(ERRANDS + "#program base.\n:- not _seen(sun).\n").goal("a", "do(walk,1)")
    assert driver.states("a")[-1] == "aborted"
    assert any("has no answer, even without goals and facts" in problem for problem in driver.journal.problems)
    assert not any("begins anew" in problem for problem in driver.journal.problems)
    driver.goal("b", "do(walk,2)")
    assert driver.states("b")[-1] == "aborted"
    assert driver.awaited == []
    assert driver.facts("_seen(sun)").goal("c", "do(walk,3)").finish().states("c")[-1] == "succeeded"


def test_program_without_any_answer_from_the_start():
    driver = Driver(ERRANDS + "#program base.\n:- not _seen(sun).\n")
    assert "no answer before any request" in driver.journal.problems[0]
    driver.facts("_seen(sun)").goal("a", "do(walk,1)").finish()
    assert driver.states("a")[-1] == "succeeded"
