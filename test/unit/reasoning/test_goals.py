import pytest
from core_driver import Driver

from rosoclingo.oclingo import parse_term
from rosoclingo.reasoning.goals import (
    TERMINAL,
    Goal,
    GoalError,
    GoalEvent,
    GoalState,
    Outcome,
    TransitionError,
    read_goal,
)
from rosoclingo.reasoning.keywords import LONGEST


def goal(text="goal(a,b,1)", key="key"):
    return Goal(key, parse_term(text))


def at(state):
    one = goal()
    one.state = state
    return one


def test_goal_event_that_its_state_excludes_is_an_error():
    one = at(GoalState.SUCCEEDED)
    with pytest.raises(TransitionError, match="succeeded"):
        one.apply(GoalEvent.ACCEPT)
    assert one.state is GoalState.SUCCEEDED


@pytest.mark.parametrize("state", sorted(set(GoalState) - set(TERMINAL), key=str))
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


def test_goal_that_is_long_and_unread_is_rejected_fast():
    message = Driver.of_shipped("paper.lp").goal("key", f"{'g' * 30000}({'a' * 30000})").message("key")
    assert message.startswith("no rule of the program can see ggg")
    assert len(message) < 1000
