"""Every event in every state of a goal has the effect in the tables of doc/statuses.md, which the test reads."""

import clingo
import pytest
from shipped import ROOT

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.events import Announcer
from rosoclingo.reasoning.goal_manager import GoalManager
from rosoclingo.reasoning.goal_status import Reading, update_status
from rosoclingo.reasoning.goals import TERMINAL, GoalEvent, GoalState, Outcome
from rosoclingo.reasoning.input_feeder import InputFeeder
from rosoclingo.reasoning.settings import CoreSettings

PAGE = (ROOT / "doc" / "statuses.md").read_text()
PROGRAM = ReactiveProgram.from_text("#external _request/2.\n#program cumulative(t).\nasked(G,t) :- _request(G,t).\n")
STATES = ("pending", "recalling", "active", "preempting", "ended")


def table():
    """Return (event, state, cell) for each cell of the page's table of events and states."""
    lines = PAGE.split("| | pending |")[1].split("\n\n")[0].splitlines()[2:]
    for line in lines:
        event, *cells = [cell.strip() for cell in line.strip("|").split("|")]
        yield from ((event, state, cell) for state, cell in zip(STATES, cells))


def a_goal(state):
    """Return a goal manager with a fed goal in a state, the goal's states from then on, and the manager."""
    events = []
    announce = Announcer(events.append, lambda: 5, PROGRAM.time_position)
    manager = GoalManager(PROGRAM, InputFeeder(), announce, CoreSettings())
    manager.add("key", "go(1)")
    goal = manager.live[0]
    goal.request_cycle = 4
    steps = {
        "pending": [],
        "recalling": [GoalEvent.CANCEL_REQUEST],
        "active": [GoalEvent.ACCEPT],
        "preempting": [GoalEvent.ACCEPT, GoalEvent.CANCEL_REQUEST],
        "ended": [GoalEvent.ACCEPT, GoalEvent.SUCCEED],
    }
    for event in steps[state]:
        goal.apply(event)
    events.clear()
    return manager, goal, events


def happen(event, manager):
    """Apply an event to all live goals."""
    word = event.partition("the program: ")[2]
    if word:
        answer = frozenset([clingo.parse_term(f"_status(1,{word},5)")])
        for goal in manager.fed:
            update_status(goal, Reading(answer, TaskPlan(), 5, 5, 9, has_rules=False))
    elif event == "the client cancels":
        manager.cancel("key")
    else:
        assert event in ("it cannot be met", "the core is stopped or shuts down")
        manager.end(manager.live, Outcome.ABORTED, "why")


@pytest.mark.parametrize(("event", "state", "cell"), list(table()))
def test_goal_events_have_the_documented_effect(event, state, cell):
    manager, goal, events = a_goal(state)
    happen(event, manager)
    expected = [] if cell == "–" else cell.split(";")[0].split(", ")
    assert [one.state.value for one in events] == expected
    ended = goal.state in TERMINAL
    assert (goal in manager.live) != ended
    assert (goal.outcome is not None and bool(goal.message)) == (ended and state != "ended")


def test_goal_event_table_is_complete():
    assert len(list(table())) == 8 * len(STATES)
    live = {state for _, state, _ in table()} - {"ended"}
    assert live == {state.value for state in set(GoalState) - set(TERMINAL)}


def test_goal_outcomes_match_the_document():
    for outcome in Outcome:
        assert f"`{outcome.name}` {int(outcome)}" in PAGE
