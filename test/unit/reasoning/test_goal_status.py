from itertools import combinations

import clingo
import pytest

from rosoclingo.oclingo import parse_term
from rosoclingo.reasoning.action_extractor import TaskPlan, extract_plan
from rosoclingo.reasoning.goal_status import Reading, Status, update_status
from rosoclingo.reasoning.goals import Goal, GoalEvent


def answer(*atoms):
    return frozenset(clingo.parse_term(atom) for atom in atoms)


def judged(*atoms, cycle=5, request_cycle=4, horizon=9, since=5, cancelling=False, has_rules=False, known=False):
    goal = Goal("key", parse_term("go(1)"))
    goal.request_cycle = request_cycle
    goal.known = known
    if cancelling:
        goal.apply(GoalEvent.CANCEL_REQUEST)
    shown = answer(*atoms)
    update_status(goal, Reading(shown, extract_plan(shown), since, cycle, horizon, has_rules))
    return goal


def reading(*atoms, cycle=0):
    return Reading(answer(*atoms), TaskPlan(), cycle, cycle, cycle, has_rules=True)


def test_goal_status_malformed_status_is_a_fault():
    faults = reading("_status(1,done,2)", "_status(1,2)", "_status(1,accepted,x)", "_status(1,5,2)").faults
    assert len(faults) == 4
    assert all("write _status(Id,S,C)" in fault for fault in faults)
    assert faults == sorted(faults)


def test_goal_status_ends_goal_with_words_of_program():
    assert judged("_status(1,succeeded,5)").message == "go(1) is met"
    assert judged("_status(1,aborted(tired),5)").message == "the program aborts go(1): tired"
    assert judged("_status(1,rejected(unknown(a)),5)").message == "the program rejects go(1): unknown(a)"


@pytest.mark.parametrize(
    ("word", "cycle", "ends"),
    [
        ("succeeded", 4, True),
        ("canceled", 5, True),
        ("succeeded", 3, False),  # before the request's own cycle any status except a rejection would be a prediction
        ("rejected", 2, False),  # the goal did not exist yet: the status is about another goal with its Id
    ],
)
def test_goal_status_end_counts_in_cycle_without_answer(word, cycle, ends):
    atoms = f"_status(1,{word},{cycle})", "_status(1,accepted,6)"
    assert judged(*atoms, cycle=6, since=2).live is not ends
    assert judged(*atoms, cycle=6, since=cycle + 1).live


def test_goal_status_worse_of_two_statuses_counts():
    for worse, better in combinations(["aborted", "rejected", "canceled", "succeeded", "accepted"], 2):
        found = reading(f"_status(1,{better}(a),2)", f"_status(1,{worse}(z,x),2)")
        assert found.status(parse_term("1"), 2) == Status(worse, "z, x")
        assert found.status(parse_term("1"), 3) is found.status(parse_term("2"), 2) is None


@pytest.mark.parametrize(
    ("atoms", "horizon", "state"),
    [
        ([], 5, "pending"),
        ([], 6, "active"),
        (["_status(1,rejected,5)"], 6, "rejected"),
        (["_status(1,rejected,6)"], 6, "rejected"),
        (["_status(1,aborted,6)"], 6, "pending"),
        (["_status(1,succeeded,6)"], 6, "active"),
    ],
)
def test_goal_status_before_cycle_of_request(atoms, horizon, state):
    assert judged(*atoms, cycle=5, request_cycle=6, horizon=horizon).state.value == state


def test_goal_status_unknown_if_program_never_mentioned_goal():
    unknown = judged("_status(2,accepted,5)", has_rules=True)
    assert unknown.state.value == "rejected"
    assert unknown.message == "the program rejects go(1): it has rules for _status, but none gives this goal a status"
    assert judged(has_rules=True, request_cycle=6).state.value == "pending"
    assert judged(has_rules=True, known=True).state.value == "succeeded"
    assert judged(has_rules=False).state.value == "succeeded"
    assert judged("_status(1,accepted,5)", has_rules=True).known


def test_goal_status_text_of_accepted_goal_is_remark():
    goal = judged('_status(1,accepted(("waits for the lift at ",3)),5)')
    assert (goal.state.value, goal.remark) == ("active", "waits for the lift at 3")
    assert judged("_status(1,accepted,5)", "_status(1,accepted(tired),5)").remark == "tired"
    assert judged("_status(1,accepted(soon),6)", cycle=5, request_cycle=6).remark == "soon"
    assert judged("_status(1,accepted,5)").remark == ""
