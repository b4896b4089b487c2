"""What an answer means for a goal: the program's word where it has one, else whether anything is left to do."""

from typing import Optional

from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.goals import Goal, Outcome
from rosoclingo.reasoning.statuses import Status, Statuses

_TEXTS = {
    Outcome.SUCCEEDED: "{} is met",
    Outcome.CANCELED: "{} is cancelled",
    Outcome.REJECTED: "the program rejects {}",
    Outcome.ABORTED: "the program gives {} up",
}


def judge(goal: Goal, statuses: Statuses, plan: TaskPlan, cycle: int, horizon: int, speaks: bool = False) -> None:
    """Bring a fed, live goal to the state that the answer of ``cycle`` gives it.

    The program's ``_status`` of the cycle decides. Where it says nothing of a goal, the goal is accepted, and met (or
    its cancellation done) as soon as no action is left in the plan; but a program that ``speaks`` of its goals, as it
    has rules for ``_status``, and has never said a word of this one does not know it, and the goal is rejected. Before
    the request's own cycle a program may say nothing yet: then acceptance and rejection are read at that cycle, as all
    else would be a prediction.
    """
    first = goal.request_cycle or cycle
    status = statuses.read(goal.identifier, cycle)
    if status is not None:
        goal.known = True
        _obey(goal, status)
    elif first > cycle:
        _judge_early(goal, statuses.read(goal.identifier, first), horizon >= first and not speaks)
    elif speaks and not goal.known:
        _end(goal, Outcome.REJECTED, "it has no word for it")
    else:
        goal.accept()
        if not plan.remaining(cycle):
            _end(goal, Outcome.CANCELED if goal.cancelling else Outcome.SUCCEEDED)


def _judge_early(goal: Goal, status: Optional[Status], seen: bool) -> None:
    if status is None:
        if seen:
            goal.accept()
    elif status.outcome is Outcome.REJECTED:
        _obey(goal, status)
    elif status.outcome in (None, Outcome.SUCCEEDED):
        goal.accept()


def _obey(goal: Goal, status: Status) -> None:
    if status.outcome is None:
        goal.accept()
    else:
        _end(goal, status.outcome, status.reason)


def _end(goal: Goal, outcome: Outcome, reason: str = "") -> None:
    text = _TEXTS[outcome].format(goal.term)
    goal.end(outcome, f"{text}: {reason}" if reason else text)
