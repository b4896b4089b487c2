import pytest
from core_driver import Driver

from rosoclingo.oclingo import parse_term
from rosoclingo.reasoning.goals import Goal, GoalError, GoalState, Outcome, TransitionError, read_goal
from rosoclingo.reasoning.keywords import LONGEST


def test_goal_event_that_its_state_excludes_is_an_error():
    one = Goal("key", parse_term("goal(a,b,1)"))
    one.end(Outcome.SUCCEEDED, "is met")
    with pytest.raises(TransitionError, match="succeeded"):
        one.end(Outcome.ABORTED, "again")
    assert (one.state, one.message) == (GoalState.SUCCEEDED, "is met")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("Disinfect(kitchen,1)", "'Disinfect.kitchen,1.' cannot be a goal: Disinfect begins .* write disinfect"),
        ("disinfect(Kitchen,1)", 'goal: Kitchen is a variable, since .* such as kitchen or "Kitchen"'),
        ("goal(office3,office2,1", "cannot be a goal"),
        ("office", "names no goal"),
        ("cancel(1)", "cancel the goal itself"),
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
    assert len(str(Goal("key", parse_term(longest)))) < 300, "messages do not repeat it all"
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
