"""Facts that are late, early, reordered or false never make the program unsatisfiable or end a goal."""

import pytest
from core_driver import Driver
from core_programs import BATTERY, DOORS
from core_scripts import play, scripts
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.oclingo import parse_update
from rosoclingo.reasoning.events import StateChanged, UpdateSent
from rosoclingo.reasoning.input_feeder import MOST_TURNS
from rosoclingo.reasoning.settings import CoreSettings

pytestmark = pytest.mark.once

MUST = "#external _must/1.\n:- _must(t), not _action_lib(rest,9,t).\n"

FACTS = {
    "fact of now has the cycle of the next action": (BATTERY, """
        facts _battery(low,now); sends _battery(low,1).; goal a do(walk,1); does walk,1,2
        facts _battery(low,now) _return(walk,1,2); goal b do(run,2); sent ..._battery(low,3)....; does run,2,4; finish
        is b succeeded"""),
    "fact of now has the cycle before where it counts from the next one on": (DOORS, """
        goal a go(den,1); finish; hear door _shut(hall,now); goal b go(hall,2); sent ..._shut(hall,2).
        does go,hall,4; finish; is b succeeded"""),
    "fact of now before the first cycle comes before the requests": (DOORS, """
        hear door _shut(den,now); goal a go(den,1); sent _shut(den,1).; does go,den,3; finish; is a succeeded"""),
    "late fact is redated": (DOORS, """
        goal a go(den,1); finish; hear door _shut(den,0); goal b go(hall,2); finish; is b succeeded; problems 1
        problem _shut(den,0) from interface door contradicts that go(den) was done in cycle 1: redated to cycle 2
        unsent ..._shut(den,0)...; sent ..._shut(den,2)..."""),
    "fact of a later cycle counts when that has come": (BATTERY + MUST, """
        goal r do(rest,9); facts _must(4); fail failed; fail failed; fail failed; finish; is r succeeded
        goal b do(run,2); finish; is b succeeded"""),
}  # fmt: skip


@scripts(FACTS)
def test_late_facts_follow_the_script(row):
    text, script = row
    driver = play(Driver(text), script)
    assert driver.core.live_goals == []


# -- several messages of one origin in one cycle: the program knows the last word


#: Goals ``visit(Room)`` and locations of persons; the robot cannot pass a closed door.
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


COMMIT = ":- not _action_lib(go,study,1)."

#: The messages while the robot drives to the study.
TURNS = {
    "turns of one update which starts the last cycle": f"""
        facts _in(study,now) _in(hall,now); facts _gone(study,now); succeed; cycle 3
        sends {COMMIT} _in(study,2). _in(hall,2). _gone(study,3). _return(go,study,1).
        goal b visit(hall); does go,hall,4""",
    "last word about a door ends the goal with the fact": """
        hear door _open(study,now); hear door _shut(study,now); fail failed; finish; is a aborted
        says a ..._shut(study,...""",
}


def driving():
    """Return a core whose robot is on its way to the study."""
    return play(Driver(VISITS, CoreSettings(horizon_limit=10)), "goal a visit(study); does go,study,1")


def believed(driver):
    """Return the program's beliefs about persons."""
    return sorted(str(atom) for atom in driver.journal.of(StateChanged)[-1].atoms if atom.name == "in")


@scripts(TURNS)
def test_message_turns_follow_the_script(row):
    driver = play(driving(), row)
    assert parse_update(driver.journal.of(UpdateSent)[-1].stream).step == driver.core.cycle


@pytest.mark.slow
def test_message_turns_are_bounded_and_last_ones_stay_ordered():
    driver = driving()
    for number in range(200):
        driver.facts(f"_in({number},now)")
    driver.facts("_gone(199,now)").succeed()
    assert driver.core.cycle == 1 + MOST_TURNS
    assert "in(199,now)" not in believed(driver)
    assert len(believed(driver)) == 199


@pytest.mark.slow
@given(
    st.lists(st.tuples(st.sampled_from(["_in", "_gone"]), st.sampled_from(["hall", "study"])), max_size=8),
)
def test_message_turns_give_same_beliefs_as_separate_cycles(words):
    driver, expected = driving(), {}
    for name, room in words:
        driver.facts(f"{name}({room},now)")
        expected[room] = name == "_in"
    driver.finish()
    assert believed(driver) == sorted(f"in({room},now)" for room, inside in expected.items() if inside)
    assert driver.states("a")[-1] == "succeeded"
    assert driver.problems == []
