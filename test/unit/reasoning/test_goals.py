import json
from unittest.mock import ANY

import pytest
from core_driver import Driver
from core_scripts import play

from rosoclingo.oclingo import parse_term
from rosoclingo.reasoning.goals import (
    CANCELLING,
    TERMINAL,
    TRANSITIONS,
    UNDECIDED,
    Goal,
    GoalError,
    GoalEvent,
    GoalState,
    Outcome,
    TransitionError,
    read_goal,
)
from rosoclingo.reasoning.keywords import LONGEST
from rosoclingo.reasoning.records import codec


def goal(text="goal(a,b,1)", key="key"):
    return Goal(key, parse_term(text))


def at(state):
    one = goal()
    one.state = state
    return one


@pytest.mark.parametrize("state", list(GoalState))
@pytest.mark.parametrize("event", list(GoalEvent))
def test_goal_transition_is_in_table_or_an_error(state, event):
    one = at(state)
    if (state, event) in TRANSITIONS:
        one.apply(event)
        assert one.state is TRANSITIONS[state, event]
    else:
        with pytest.raises(TransitionError, match=state.value):
            one.apply(event)
        assert one.state is state


def test_goal_terminal_states_are_those_of_actionlib():
    names = {"RECALLED", "REJECTED", "PREEMPTED", "SUCCEEDED", "ABORTED"}
    assert {state.name for state in TERMINAL} == names
    assert not TERMINAL & (CANCELLING | UNDECIDED)


@pytest.mark.parametrize("state", sorted(set(GoalState) - TERMINAL, key=str))
@pytest.mark.parametrize("outcome", list(Outcome))
def test_goal_that_lives_can_have_every_outcome(state, outcome):
    one = at(state)
    one.end(outcome, "why")
    assert one.state in TERMINAL
    assert one.message == "why"


def test_goal_that_was_accepted_is_aborted_not_rejected():
    one = at(GoalState.ACTIVE)
    one.end(Outcome.REJECTED, "why")
    assert (one.state, one.outcome) == (GoalState.ABORTED, Outcome.ABORTED)


@pytest.mark.parametrize("outcome", list(Outcome))
def test_goal_ends_once(outcome):
    one = at(GoalState.SUCCEEDED)
    with pytest.raises(TransitionError):
        one.end(outcome, "again")
    assert one.message == ""


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "cannot be a goal"),
        ("Disinfect(kitchen,1)", "'Disinfect.kitchen,1.' cannot be a goal: Disinfect begins .* write disinfect"),
        ("disinfect(Kitchen,1)", 'goal: Kitchen is a variable, since .* such as kitchen or "Kitchen"'),
        ("goal(X,office2,1)", "cannot be a goal"),
        ("goal(office3,office2,1", "cannot be a goal"),
        ("goal(a). goal(b)", "cannot be a goal"),
        ("not a", "cannot be a goal"),
        ("office", "names no goal"),
        ("17", "names no goal"),
        ("cancel(1)", "cancel the goal itself"),
        ("\x00", "cannot be a goal"),
        ("goal(" * 2000, "cannot be a goal"),
    ],
)
def test_goal_that_cannot_be_read_is_rejected(text, reason):
    with pytest.raises(GoalError, match=reason):
        read_goal(text)


def test_goal_length_is_limited():
    longest = f'goal("{"x" * (LONGEST - 10)}",1)'
    assert len(longest) == LONGEST
    assert str(read_goal(longest)) == longest
    assert len(str(goal(longest))) < 300, "messages do not repeat it all"
    with pytest.raises(GoalError, match=f"too long for a goal: write at most {LONGEST} characters") as error:
        read_goal(longest.replace("x", "xx", 1))
    assert len(str(error.value)) < 400


def test_goal_with_deep_nesting_is_rejected_harmlessly():
    for text in ("f(" * 10_000 + "1" + ")" * 10_000, "(" * 10_000 + "," * 10_000, "-f(" * 10_000, "f((" * 10_000):
        driver = Driver().goal("deep", text).facts("_seen(" + text + ")")
        assert "nested deeper than 256 levels" in driver.message("deep")
        assert "nested deeper than 256 levels" in driver.journal.problems[0]
        assert len(driver.message("deep")) < 400
        assert driver.goal("a", "do(walk,1)").finish().states("a")[-1] == "succeeded"


def test_goal_keeps_its_documented_fields():
    encode, decode = codec(Goal)
    one = Goal("key", parse_term("goal(a,b,1)"), GoalState.PREEMPTING, 4, True, True, 2, 5, 3, True, True)
    record = json.loads(json.dumps(encode(one), allow_nan=False))
    assert record["term"] == "goal(a,b,1)"
    assert vars(decode(record)) == {**vars(one), "observer": ANY}


@pytest.mark.parametrize(
    ("text", "advice"),
    [
        ("gaol(office3,office2,1)", "did you mean goal(office3,office2,1)?"),
        ("gOAL(office3,office2,1)", "did you mean goal(office3,office2,1)?"),
        ("goal(office3,office2)", "rules match goal(From,To,Id)"),
        ("goal(goal(office3,office2,1))", "rules match goal(From,To,Id)"),
        ("fetch(cup)", "rules match goal(From,To,Id)"),
    ],
)
def test_goal_that_no_rule_reads_is_rejected(text, advice):
    play(
        Driver.of_shipped("paper.lp"),
        f"""
        goal key {text}; says key no rule of the program can see {text}: {advice}; all key rejected; unsent ...""",
    )


def test_goal_that_is_long_and_unread_is_rejected_fast():
    message = Driver.of_shipped("paper.lp").goal("key", f"{'g' * 30000}({'a' * 30000})").message("key")
    assert message.startswith("no rule of the program can see ggg")
    assert len(message) < 1000


def test_goal_of_the_paper_is_planned():
    play(
        Driver.of_shipped("paper.lp"),
        """
        goal a goal(office3,office2,1); goal b goal(office1,office2,"b"); finish; all a active succeeded
        all b active succeeded""",
    )


VISITS = """
#external _request/2. #external _return/3.
#program base.
room(hall). room(study).
#program cumulative(t).
asked(R,t) :- _request(visit(R),t+1).
wanted(R,t) :- asked(R,t), room(R).
{ _action_lib(go,R,t) : wanted(R,t) } 1.
:- wanted(R,t), not _action_lib(go,R,t).
#show _action_lib/3.
"""


def test_goal_about_unknown_things_is_rejected():
    advice = {
        "visit(attic)": "attic is none of hall, study",
        'visit("hall")': "did you mean visit(hall)?",
        "visit(studi)": "did you mean visit(study)?",
        "visti(hall)": "did you mean visit(hall)?",
    }
    driver = Driver(VISITS)
    for key, text in enumerate(advice):
        play(driver, f"goal {key} {text}; says {key} no rule of the program can see {text}: {advice[text]}")
    play(driver, "goal good visit(hall); finish; all good active succeeded")
