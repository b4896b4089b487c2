"""The verdict of an attempt about its action, including the effects of earlier goals."""

import pytest
from clingo import Function

from rosoclingo.interfaces.attempt import ActionEvent, ActionLimits, Attempt, Instant
from rosoclingo.interfaces.facts import Sender
from rosoclingo.interfaces.templates import GoalEnd
from rosoclingo.reasoning.keywords import Action

NOW = Instant(10.0, 10.0)
PICK = Action(Function("pick"), Function("cup"), 1)


def attempt(*events, ended=None, **limits):
    one = Attempt(PICK, None, Sender("core", None), ActionLimits(retries=1, **limits), NOW)
    return after(one, *events, ended=ended)


def after(one, *events, ended=None):
    one.ended = ended
    for event in events:
        one.process(event, NOW)
    return one


SENT = (ActionEvent.SERVER_FOUND, ActionEvent.ACKNOWLEDGED)


@pytest.mark.parametrize("status", ["preempted", "recalled", "aborted", "rejected", "succeeded"])
def test_attempt_with_cancelled_goal_ends_as_server_says(status):
    event = ActionEvent.PREEMPTED if status in ("preempted", "recalled") else ActionEvent.ENDED
    assert attempt(*SENT, ActionEvent.CANCEL, event, ended=GoalEnd(status)).conclusion.status == status


@pytest.mark.parametrize("why", [ActionEvent.CANCEL, ActionEvent.EXPIRED])
def test_attempt_goal_that_outlives_its_cancel_is_lost(why):
    one = attempt(*SENT, why, ActionEvent.EXPIRED)
    assert one.conclusion.status == "server_lost"
    assert not one.should_retry(one.conclusion, Function("server_lost"), ("server_lost",))


def test_attempt_cancelled_between_goals_keeps_first_end():
    first = attempt(*SENT, ActionEvent.ENDED, ended=GoalEnd("aborted", "slipped"))
    assert first.should_retry(first.conclusion, Function("failed"), ("failed",))
    second = first.next_attempt(first.conclusion, NOW)
    assert after(second, ActionEvent.CANCEL).conclusion == GoalEnd("aborted", "slipped")


@pytest.mark.parametrize(
    ("events", "ended"),
    [([ActionEvent.CANCEL], None), ([*SENT, ActionEvent.CANCEL, ActionEvent.PREEMPTED], GoalEnd("preempted"))],
)
def test_attempt_with_uncertain_earlier_goal_is_not_preempted(events, ended):
    first = attempt(*SENT, ActionEvent.SERVER_LOST)
    first.uncertain = True
    second = first.next_attempt(first.conclusion, NOW)
    assert second.limits.retries == 0
    assert after(second, *events, ended=ended).conclusion.status == "server_lost"


def test_attempt_of_unwanted_action_is_not_sent_again():
    one = attempt(*SENT, ActionEvent.ENDED, ended=GoalEnd("aborted"))
    one.cancelled = True
    assert not one.should_retry(one.conclusion, Function("failed"), ("failed",))
