"""The goal manager: admission, queued goals, and reports to clients."""

import pytest
from core_scripts import perform
from goal_clients import Clients, crowd

from rosoclingo.reasoning.goals import GoalState, Outcome


def test_goal_manager_admits_next_goal_after_an_end():
    clients = crowd(4, at_once=2)
    clients.goals.end(clients.goals.fed[:1], Outcome.SUCCEEDED, "is done")
    assert clients.feed(2) == ["_request(go(3),3)"]
    clients.goals.end(clients.goals.fed, Outcome.SUCCEEDED, "is done")
    assert clients.feed(3) == ["_request(go(4),4)"]
    assert clients.live == ["g4"]


def test_goal_manager_cancels_unsent_goals_at_once():
    clients = perform(Clients(at_once=1), "add 1-3; lacks 2 3; cancel 2; lacks 3; cancel 1")
    assert clients.feed() == ["_request(go(3),2)"]
    assert clients.ends() == [("g2", Outcome.CANCELED), ("g1", Outcome.CANCELED)]


def test_goal_manager_cancels_program_goals_once_by_update():
    clients = perform(crowd(2), "cancel 1; cancel 1")
    assert clients.feed(2) == ["_request(cancel(1),2)"]
    clients.goals.drop(clients.goals.fed[1:], "cannot be met")
    assert clients.feed(4) == ["_request(cancel(2),4)"]
    assert clients.ends() == [("g2", Outcome.ABORTED)]
    assert clients.live == ["g1"]


def test_goal_manager_leaves_ended_goals_unchanged():
    clients = Clients().add(1, 2)
    goals = clients.goals.live
    clients.goals.end(goals[:1], Outcome.SUCCEEDED, "is done")
    clients.goals.end(goals, Outcome.ABORTED, "is given up")
    assert [goal.state for goal in goals] == [GoalState.SUCCEEDED, GoalState.ABORTED]
    assert clients.feed() == []


def test_goal_manager_ends_only_undeclared_requests():
    clients = crowd(2)
    warning = "Head _request(go(2),2) has not been declared external. The entire rule will be ignored."
    clients.goals.reject_undeclared(clients.goals.fed, ["something else", warning])
    assert clients.live == ["g1"]
    assert clients.ends() == [("g2", Outcome.REJECTED)]


@pytest.mark.parametrize(
    ("key", "text", "reason"),
    [
        ("g1", "go(2)", "is in use"),
        ("g2", "stay(1)", "is in use"),
        ("g2", "go(", "cannot be a goal"),
        ("g2", "(go,2)", "names no goal"),
    ],
)
def test_goal_manager_rejects_goals(key, text, reason):
    clients = Clients().add(1)
    clients.goals.add(key, text)
    refused = clients.reports[-1]
    assert (refused.cycle, refused.key, refused.state, refused.outcome) == (
        7,
        key,
        GoalState.REJECTED,
        Outcome.REJECTED,
    )
    assert reason in refused.message
    assert clients.live == ["g1"]


def test_goal_manager_rejects_all_without_declared_requests():
    clients = Clients("#external _request/1.").add(1)
    assert "no external _request/2" in clients.reports[0].message
    assert clients.live == []


def test_goal_manager_resends_live_goals_to_restarted_program():
    clients = crowd(3)
    goals = clients.goals.live
    clients.end(1).goals.resend(goals)
    assert clients.fed == [], "it knows none of them"
    clients.cancel(3)
    assert clients.ends()[-1] == ("g3", Outcome.CANCELED), "at once"
    assert clients.feed(2) == ["_request(go(2),3)"]
