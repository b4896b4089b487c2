"""Facts of one origin that come in several messages during one cycle: the program knows which was the last word."""

import pytest
from core_driver import Driver
from hypothesis import given, settings
from hypothesis import strategies as st

from rosoclingo.oclingo import parse_update
from rosoclingo.reasoning import ActionsPreempted, CoreSettings, StateChanged, UpdateSent
from rosoclingo.reasoning.input_feeder import MOST_TURNS

#: Goals ``visit(Room)``; where persons are; nobody drives through a door that is shut.
VISITS = """
#external _request/2. #external _return/3. #external _in/2. #external _gone/2. #external _shut/2. #external _open/2.
#program base.
room(hall). room(study). at(hall,0).
#program cumulative(t).
in(R,t) :- _in(R,t).
in(R,t) :- in(R,t-1), not _gone(R,t).
shut(R,t) :- _shut(R,t).
shut(R,t) :- shut(R,t-1), not _open(R,t).
wanted(R,t) :- _request(visit(R),t+1).
wanted(R,t) :- wanted(R,t-1), not at(R,t-1), not _request(cancel(R),t).
{ _action_lib(go,R,t) : room(R), not at(R,t-1) } 1 :- wanted(_,t).
failed(t) :- _action_lib(go,R,t), _return(go,V,t), V != R.
moved(t) :- _action_lib(go,R,t), not failed(t).
at(R,t) :- _action_lib(go,R,t), not failed(t).
at(R,t) :- at(R,t-1), not moved(t).
:- _action_lib(go,R,t), shut(R,t-1).
#show _action_lib/3. #show in/2.
#program volatile(t).
:- wanted(R,t), not at(R,t).
"""

#: Who finds a door shut may knock instead.
KNOCK = """
#program cumulative(t).
{ _action_lib(knock,R,t) } :- wanted(R,t), shut(R,t-1).
at(R,t) :- _action_lib(knock,R,t).
"""

#: The same, but with a goal open something is done in each cycle.
RESTLESS = VISITS.replace("{ _action_lib(go", "1 { _action_lib(go").replace("not at(R,t-1) }", "R != none }")


def driving(text=VISITS):
    """A core whose robot is on its way to the study."""
    driver = Driver(text, CoreSettings(horizon_limit=10)).goal("a", "visit(study)")
    assert driver.awaited == ["_action_lib(go,study,1)"]
    return driver


def believed(driver):
    """What the program believes of persons."""
    return sorted(str(atom) for atom in driver.journal.of(StateChanged)[-1].atoms if atom.name == "in")


def fed(driver):
    """The facts of now of the last update, each with its cycle."""
    return [line for line in driver.journal.of(UpdateSent)[-1].text.splitlines() if line.startswith(("_in", "_gone"))]


def test_turns_of_one_update_which_starts_the_last_cycle():
    driver = driving()
    driver.facts("_in(study,now)", "_in(hall,now)").facts("_gone(study,now)").succeed()
    assert fed(driver) == ["_in(study,2).", "_in(hall,2).", "_gone(study,3)."]
    assert parse_update(driver.journal.of(UpdateSent)[-1].stream).step == 3
    assert driver.core.cycle == 3
    assert driver.goal("b", "visit(hall)").awaited == ["_action_lib(go,hall,4)"]


def test_turns_of_facts_that_are_repeated_are_one():
    driver = driving()
    for _ in range(50):
        driver.facts("_in(study,now)")
    driver.succeed()
    assert fed(driver) == ["_in(study,2)."]
    assert driver.core.cycle == 2


def test_turns_of_several_origins_run_side_by_side():
    driver = driving()
    for origin, fact in [("eye", "_in(hall,now)"), ("ear", "_in(study,now)"), ("ear", "_gone(study,now)")]:
        driver.core.receive(origin, [fact])
    driver.succeed()
    assert fed(driver) == ["_in(study,2).", "_in(hall,3).", "_gone(study,3)."]


def test_turns_are_not_for_facts_that_name_their_cycle():
    driver = driving()
    driver.facts("_in(study,1)").facts("_gone(study,2)").succeed()
    assert fed(driver) == ["_in(study,1).", "_gone(study,2)."]
    assert driver.core.cycle == 2
    assert believed(driver) == []


def test_turns_before_the_first_cycle_are_cycles_of_their_own():
    driver = Driver(VISITS, CoreSettings(horizon_limit=10), start=False)
    for word in ("_shut(study,now)", "_open(study,now)"):
        driver.core.receive("door", [word])
    driver.core.add_goal("a", "visit(study)")
    driver.begin().finish()
    assert driver.states("a")[-1] == "succeeded"
    assert driver.problems == []


def test_turns_of_a_door_give_no_goal_up_for_an_old_word():
    driver = driving()
    for word in ("_shut(study,now)", "_open(study,now)"):
        driver.core.receive("door", [word])
    driver.fail("failed").finish()
    assert driver.states("a")[-1] == "succeeded"


def test_turns_of_a_door_that_is_shut_at_last_end_the_goal_with_the_fact():
    driver = driving()
    for word in ("_open(study,now)", "_shut(study,now)"):
        driver.core.receive("door", [word])
    driver.fail("failed").finish()
    assert driver.states("a")[-1] == "aborted"
    assert "_shut(study," in driver.message("a")


@pytest.mark.parametrize(("words", "ended"), [(["_shut", "_open"], 0), (["_open", "_shut"], 1)])
def test_turns_decide_whether_an_action_is_still_wanted(words, ended):
    driver = Driver(VISITS + KNOCK, CoreSettings(horizon_limit=10, preempt=True)).goal("a", "visit(study)")
    for word in words:  # the core looks at what runs once both have come
        driver.core.receive("door", [f"{word}(study,now)"])
    assert len(driver.run().journal.of(ActionsPreempted)) == ended


def test_turns_are_bounded_and_the_last_ones_keep_their_order():
    driver = driving()
    for number in range(200):
        driver.facts(f"_in({number},now)")
    driver.facts("_gone(199,now)").succeed()
    assert driver.core.cycle == 1 + MOST_TURNS
    assert "in(199,now)" not in believed(driver)
    assert len(believed(driver)) == 199


@settings(max_examples=40)
@given(
    st.lists(st.tuples(st.sampled_from(["_in", "_gone"]), st.sampled_from(["hall", "study"])), max_size=8),
    st.booleans(),
)
def test_turns_leave_the_beliefs_that_one_message_a_cycle_leaves(words, restless):
    driver, expected = driving(RESTLESS if restless else VISITS), {}
    for name, room in words:
        driver.facts(f"{name}({room},now)")
        expected[room] = name == "_in"
    driver.finish()
    assert believed(driver) == sorted(f"in({room},now)" for room, inside in expected.items() if inside)
    assert driver.states("a")[-1] == "succeeded"
    assert driver.problems == []
