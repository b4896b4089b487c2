"""Inquiries about actions that have perhaps been executed: the server is asked first, then the world."""

import pytest
from clingo import Function

from rosoclingo.interfaces.attempt import RESULT_GRACE, ActionEvent, ActionLimits, Attempt, Instant, Phase
from rosoclingo.interfaces.facts import Sender
from rosoclingo.reasoning.keywords import Action

LIMIT = 5.0
HELD, ENDED, ABSENT = ActionEvent.FOUND, ActionEvent.ENDED, ActionEvent.SERVER_LOST
PICK = Action(Function("pick"), Function("cup"), 1)

#: The words of an outcome, and the phase and the end that follow for an action that is not repeatable.
OUTCOMES = {
    "OPEN": ("", Phase.ASKING, None),
    "HELD": ("the server has its goal: it is running", Phase.RUNNING, None),
    "DONE": ("it was done", Phase.DONE, "succeeded"),
    "NOT_DONE": ("it was not done", Phase.WAITING, None),
    "UNKNOWN": ("its outcome is unknown", Phase.DONE, "interrupted"),
}


def inquiry(*says, repeatable=False):
    """Return an attempt that asks from time 10 on, which the world answers in turn with these words, if any."""
    words, now = iter(says), Instant(10.0, 10.0)
    one = Attempt(PICK, None, Sender("core", None), ActionLimits(server_timeout=LIMIT), now, repeatable)
    one.goal_id = "earlier"
    one.begin_asking((lambda: next(words)) if says else None, now)
    return one


@pytest.mark.parametrize(
    ("says", "looks"),
    [
        # the server is asked first
        ([True], [(HELD, 10.0, "HELD")]),
        ([True], [(None, 14.9, "OPEN"), (ABSENT, 14.95, "DONE")]),
        ([], [(None, 15.0, "UNKNOWN")]),
        # then the world; an unreachable server can still execute the action
        ([True], [(None, 15.0, "DONE")]),
        ([False], [(None, 15.0, "UNKNOWN")]),
        ([None], [(None, 15.0, "UNKNOWN")]),
        # the world can take some time
        ([None, None, True], [(ABSENT, 10.0, "OPEN"), (ABSENT, 14.0, "OPEN"), (ABSENT, 16.0, "DONE")]),
        ([None, None, False], [(ABSENT, 10.0, "OPEN"), (ABSENT, 14.0, "OPEN"), (ABSENT, 16.0, "NOT_DONE")]),
        ([None, None], [(ABSENT, 14.0, "OPEN"), (ABSENT, 15.0, "UNKNOWN")]),
        ([], [(ABSENT, 10.0, "UNKNOWN")]),
        # the result of a goal that has ended can be late
        ([], [(ENDED, 11.0, "OPEN"), (HELD, 11.1, "HELD")]),
        ([], [(ENDED, 11.0, "OPEN"), (ENDED, 11.0 + RESULT_GRACE, "UNKNOWN")]),
    ],
)
def test_inquiry_asks_the_server_and_then_the_world(says, looks):
    one = inquiry(*says)
    for report, time, result in looks:
        words, phase, end = OUTCOMES[result]
        assert (one.ask(report, Instant(time, time)), one.phase) == (words, phase)
        assert end is None or one.conclusion.status == end


@pytest.mark.parametrize("last", [ENDED, None])
def test_inquiry_does_not_reuse_id_of_ended_goal(last):
    one = inquiry(repeatable=True)
    for report, time in ((ENDED, 10.0), (last, 10.0 + LIMIT)):
        one.ask(report, Instant(time, time))
    assert (one.phase, one.goal_id) == (Phase.WAITING, "")
    one = inquiry(None, False)
    one.ask(ENDED, Instant(10.0, 10.0))
    one.ask(ABSENT, Instant(10.1, 10.1))  # the server has forgotten it meanwhile
    assert one.ask(ABSENT, Instant(10.2, 10.2)) == "it was not done"
    assert (one.phase, one.goal_id) == (Phase.WAITING, "earlier")


@pytest.mark.parametrize(("says", "end"), [(True, "succeeded"), (False, "server_lost"), (None, "server_lost")])
def test_inquiry_after_lost_goal_ends_the_attempt(says, end):
    one, now = inquiry(repeatable=True), Instant(20.0, 20.0)
    one.ask(HELD, now)
    one.handle = "goal"
    one.process(ActionEvent.SERVER_LOST, now)
    assert one.needs_check
    one.begin_asking(lambda: says, now)
    one.ask(ABSENT, Instant(26.0, 26.0))
    assert (one.done, one.conclusion.status, one.needs_check, one.uncertain) == (True, end, False, says is None)
