"""The life of one goal: every event in every phase, deadlines, irregular clocks."""

import pytest
from clingo import Function
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.interfaces.attempt import (
    START_TIME,
    TRANSITIONS,
    ActionEvent,
    ActionLimits,
    Attempt,
    Effect,
    Instant,
    Phase,
)
from rosoclingo.interfaces.facts import Sender
from rosoclingo.interfaces.templates import GoalEnd
from rosoclingo.reasoning.keywords import Action

LIMITS = ActionLimits(timeout=10.0, server_timeout=5.0)
START = Instant(100.0, 50.0)
WAYS = {
    Phase.WAITING: [],
    Phase.SENT: [ActionEvent.SERVER_FOUND],
    Phase.RUNNING: [ActionEvent.SERVER_FOUND, ActionEvent.ACKNOWLEDGED],
    Phase.ENDING: [ActionEvent.SERVER_FOUND, ActionEvent.ACKNOWLEDGED, ActionEvent.CANCEL],
    Phase.YIELDING: [ActionEvent.SERVER_FOUND, ActionEvent.ACKNOWLEDGED, ActionEvent.PREEMPTED],
    Phase.DONE: [ActionEvent.CANCEL],
}


def goal_run(limits=LIMITS, now=START):
    return Attempt(Action(Function("pick"), Function("cup"), 1), None, Sender("core", None), limits, now)


def run_in(phase, limits=LIMITS, now=START):
    run = goal_run(limits, now)
    for event in WAYS[phase]:
        run.process(event, now)
    assert run.phase is phase
    return run


def later(ros=0.0, wall=0.0):
    return Instant(START.ros + ros, START.wall + wall)


def test_goal_run_rejects_only_impossible_events():
    asking = (ActionEvent.FOUND, ActionEvent.DECIDED, ActionEvent.UNDECIDED)
    phases, events = set(Phase) - {Phase.ASKING}, set(ActionEvent) - {*asking}
    illegal = {(phase, event) for phase in phases for event in events if event not in TRANSITIONS[phase]}
    assert illegal == {
        (Phase.WAITING, ActionEvent.ACKNOWLEDGED),
        (Phase.WAITING, ActionEvent.ENDED),
        (Phase.WAITING, ActionEvent.PREEMPTED),
        (Phase.WAITING, ActionEvent.SERVER_LOST),
        (Phase.SENT, ActionEvent.SERVER_FOUND),
        (Phase.RUNNING, ActionEvent.SERVER_FOUND),
        (Phase.ENDING, ActionEvent.SERVER_FOUND),
        (Phase.YIELDING, ActionEvent.SERVER_FOUND),
    }
    assert TRANSITIONS[Phase.ASKING].keys() == {*asking, ActionEvent.SHUTDOWN}


@pytest.mark.parametrize(
    ("phase", "event", "verdict"),
    [
        (Phase.WAITING, ActionEvent.CANCEL, "preempted"),
        (Phase.WAITING, ActionEvent.SHUTDOWN, "interface_lost"),
        (Phase.SENT, ActionEvent.CANCEL, None),
        (Phase.SENT, ActionEvent.SERVER_LOST, "server_lost"),
        (Phase.RUNNING, ActionEvent.ENDED, None),
        (Phase.RUNNING, ActionEvent.SERVER_LOST, "server_lost"),
        (Phase.RUNNING, ActionEvent.SHUTDOWN, "interface_lost"),
        (Phase.ENDING, ActionEvent.ENDED, None),
        (Phase.ENDING, ActionEvent.SERVER_LOST, "server_lost"),
        (Phase.YIELDING, ActionEvent.EXPIRED, None),
        (Phase.YIELDING, ActionEvent.SERVER_LOST, "server_lost"),
        (Phase.DONE, ActionEvent.SERVER_LOST, "preempted"),
    ],
)
def test_goal_run_verdicts_follow_the_table(phase, event, verdict):
    run = run_in(phase)
    run.process(event, START)
    assert run.verdict == verdict


NEVER = LIMITS._replace(timeout=0.0)


@pytest.mark.parametrize(
    ("phase", "limits", "ticks", "verdict"),
    [
        # an absent server is lost by the wall clock, a connected one by both clocks
        (Phase.WAITING, LIMITS, [(1000.0, 4.9, "NOTHING"), (0.0, 5.0, "FINISH")], "server_lost"),
        (Phase.SENT, LIMITS, [(1000.0, 4.9, "NOTHING")], None),
        (Phase.SENT, LIMITS, [(4.9, 1000.0, "NOTHING"), (5.0, 5.0, "ABANDON")], "server_lost"),
        (Phase.ENDING, LIMITS, [(1000.0, 4.9, "NOTHING")], None),
        (Phase.ENDING, LIMITS, [(4.9, 1000.0, "NOTHING"), (5.0, 5.0, "FINISH")], "server_lost"),
        # a slow goal is cancelled, unless there is no limit
        (Phase.RUNNING, LIMITS, [(9.9, 1000.0, "NOTHING"), (10.0, 1.0, "CANCEL")], "timeout"),
        (Phase.RUNNING, NEVER, [(1e9, 1e9, "NOTHING")], None),
        # a clock that is set back restarts the deadline
        (Phase.RUNNING, LIMITS, [(-99.0, 1.0, "NOTHING"), (-89.1, 2.0, "NOTHING"), (-89.0, 3.0, "CANCEL")], "timeout"),
    ],
)
def test_goal_run_ends_at_its_deadline(phase, limits, ticks, verdict):
    run = run_in(phase, limits)
    for ros, wall, effect in ticks:
        assert run.tick(later(ros, wall)) is Effect[effect]
    assert run.verdict == verdict


def test_goal_run_waits_for_starting_server_with_one_report():
    run = run_in(Phase.WAITING)
    reported = [run.wait_on(later(wall=second)) for second in range(1, 100)]
    assert reported == [True] + [False] * 98
    assert run.tick(later(wall=99.0 + 4.9)) is Effect.NOTHING
    assert run.tick(later(wall=99.0 + 5.0)) is Effect.FINISH
    assert run.verdict == "server_lost"
    run = run_in(Phase.WAITING)
    for second in range(1, int(START_TIME) + 10):
        run.wait_on(later(wall=second))
        run.tick(later(wall=second))
    assert run.verdict == "server_lost", "it never starts"


def test_goal_run_timeout_counts_from_sending():
    run = run_in(Phase.SENT)
    run.process(ActionEvent.ACKNOWLEDGED, later(9.0, 1.0))
    assert run.tick(later(10.0, 1.0)) is Effect.CANCEL
    assert run.tick(later(15.0, 6.1)) is Effect.FINISH
    assert (run.verdict, run.cancel_ignored) == ("server_lost", True)


@pytest.mark.parametrize("phase", [Phase.SENT, Phase.RUNNING])
def test_goal_run_waits_for_server_busy_with_others(phase):
    run = run_in(phase, LIMITS._replace(pause=2.0))
    assert run.process(ActionEvent.PREEMPTED, START) is Effect.NOTHING
    assert run.tick(later(1.9, 1000.0)) is Effect.NOTHING
    assert run.tick(later(2.0, 0.1)) is Effect.FINISH


@given(
    st.lists(st.one_of(st.sampled_from(list(ActionEvent)), st.tuples(st.floats(0, 20), st.floats(0, 20))), max_size=30)
)
def test_goal_run_ends_once_and_is_preempted_only_by_the_server(arrivals):
    """The run can report that nothing has happened only for a goal that was never sent."""
    run, now, finished, sent = goal_run(), START, 0, False
    for happening in arrivals:
        if isinstance(happening, ActionEvent):
            if happening not in TRANSITIONS[run.phase]:
                continue
            effect = run.process(happening, now)
        else:
            now = Instant(now.ros + happening[0], now.wall + happening[1])
            effect = run.tick(now)
        sent |= effect is Effect.SEND
        finished += effect in (Effect.FINISH, Effect.ABANDON)
        assert finished == (1 if run.done else 0)
    assert run.verdict != "preempted" or not sent
    assert not run.cancel_ignored or run.verdict in ("server_lost", "interface_lost")
    run.tick(Instant(now.ros + 100, now.wall + 100))
    run.tick(Instant(now.ros + 200, now.wall + 200))
    assert run.done


# ---- further goals for an action ------------------------------------------------------------------------------------

SLIPPED, FAILED = GoalEnd("aborted", "slipped"), (Function("failed"), ("failed",))


def ended(end, *events, cancelled=False):
    """Return an action whose goal has been sent, and has ended after these events."""
    run = run_in(Phase.RUNNING, LIMITS._replace(retries=1))
    run.cancelled = cancelled
    run.ended = end
    for event in events:
        run.process(event, START)
    return run


def test_goal_run_cancelled_between_goals_keeps_first_end():
    first = ended(SLIPPED, ActionEvent.ENDED)
    assert first.should_retry(first.conclusion, *FAILED)
    second = first.next_attempt(first.conclusion, START)
    second.process(ActionEvent.CANCEL, START)
    assert second.conclusion == SLIPPED


def test_goal_run_of_unwanted_or_stubborn_action_is_not_sent_again():
    for run, status in (
        (ended(SLIPPED, ActionEvent.ENDED, cancelled=True), "aborted"),
        (ended(None, ActionEvent.CANCEL, ActionEvent.EXPIRED), "server_lost"),
    ):
        assert run.conclusion.status == status
        assert not run.should_retry(run.conclusion, *FAILED)


@pytest.mark.parametrize("events", [[], [*WAYS[Phase.RUNNING], ActionEvent.CANCEL, ActionEvent.PREEMPTED]])
def test_goal_run_with_uncertain_earlier_goal_is_not_preempted(events):
    first = ended(None, ActionEvent.SERVER_LOST)
    first.uncertain = True
    second = first.next_attempt(first.conclusion, START)
    assert second.limits.retries == 0
    second.ended = GoalEnd("preempted") if events else None
    for event in events or [ActionEvent.CANCEL]:
        second.process(event, START)
    assert second.conclusion.status == "server_lost"
