"""Messages of the core leave once they are durable; each goal stays in the journal until its end is reported."""

import json

import pytest
from core_driver import ERRANDS, shortest
from full_disk import room_for
from kept_node import PROGRAM

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import ActionsDispatched, ActionsPreempted, GoalChanged, ReturnAccepted
from rosoclingo.reasoning.goals import GoalState, Outcome
from rosoclingo.reasoning.journal import folder
from rosoclingo.reasoning.journal.database import Header
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.journal.keeper import ClientGoal, Ending, Keeper
from rosoclingo.reasoning.settings import CoreSettings


def test_keeper_writes_to_disk_before_messages_leave(start):
    node = start()

    def look(event):
        state = node.on_disk
        assert state["core:step"] >= event.cycle or event.cycle == 1
        if isinstance(event, ActionsDispatched):
            assert str(event.actions[0].atom) in json.dumps(state["execution:dispatches"])
        if isinstance(event, GoalChanged) and event.outcome is not None:
            assert f"goal:{event.key}" not in state
            ending = {"state": event.state.value, "outcome": int(event.outcome), "message": event.message}
            assert state[f"client:{event.key}"]["ending"] == ending

    node.at_event = look
    node.goal("a", "do(walk,1)").goal("b", "do(").succeed()
    ends = [
        event.state.value for event in node.published if isinstance(event, GoalChanged) and event.outcome is not None
    ]
    assert ends == ["rejected", "succeeded"]
    assert not node.keeper.clients


def test_keeper_makes_a_return_durable_at_once(start):
    node = start()
    node.goal("a", "do(walk,1)")
    (action,) = node.core.awaited
    node.core.receive("hand", [f"_return({action.interface},{action.parameter},{action.cycle})"])
    node.keeper.send()
    assert [type(event) for event in node.published][-1] is ReturnAccepted
    assert start().core.awaited == ()


def test_keeper_holds_unconfirmed_end_until_it_expires(start):
    node = start()
    node.goal("a", "do(walk,1)")
    (action,) = node.core.awaited
    node.core.receive("hand", [f"_return({action.interface},{action.parameter},{action.cycle})"])
    while node.core.advance(1.0):
        node.keeper.send(keep_ends=True)
    assert any(isinstance(event, GoalChanged) and event.outcome is not None for event in node.published)
    again = start()
    assert again.keeper.clients["a"].ending == Ending(GoalState.SUCCEEDED, Outcome.SUCCEEDED, "do(walk,1) is met")
    again.keeper.forget(["a"])
    again.goal("b", "do(walk,2)")
    assert list(start().keeper.clients) == ["b"]


#: Any number of concurrent errands; the program observes ended actions and accepts no other preemption.
TOGETHER = (
    ERRANDS.replace("W != quick } 1.", "W != quick }.")
    + """
#external _cancel/3.
#program cumulative(t).
:- _return(W,preempted,t), not _cancel(W,_,t).
"""
)


@pytest.mark.parametrize("text", [ERRANDS, TOGETHER])
def test_keeper_shutdown_cancels_each_action_under_way(start, text):
    program = ReactiveProgram.from_text(text)
    node = start(program)
    node.core.add_goal("a", "do(walk,1)")
    node.goal("b", "do(run,2)")
    under_way = node.core.awaited
    assert len(under_way) == (2 if text is TOGETHER else 1)

    def look(event):
        if isinstance(event, ActionsPreempted):
            found = json.dumps(node.on_disk["preemption:found"])
            assert all(str(one.atom) in found for one in under_way), "written before"

    node.at_event = look
    node.core.shut_down("is aborted: the core shuts down")
    node.keeper.send()
    assert [one.actions for one in node.published if isinstance(one, ActionsPreempted)] == [under_way]
    ends = [one for one in node.published if isinstance(one, GoalChanged) and one.outcome is Outcome.ABORTED]
    assert len(ends) == 2
    again = start(program)
    assert again.core.awaited == again.core.preempted == under_way, (
        "late subscribers receive the actions and their ends"
    )
    for one in under_way:
        again.core.receive("hand", [f"_return({one.interface},preempted,{one.cycle})"])
    again.run()
    assert not again.core.awaited
    assert not again.core.plan.remaining(again.core.cycle), "nothing is done for a goal that was aborted"
    again.goal("c", "do(walk,3)").succeed()
    assert [one.outcome for one in again.published if isinstance(one, GoalChanged)][-1] is Outcome.SUCCEEDED


def test_keeper_second_shutdown_cancels_no_action_twice(start):
    node = start()
    node.goal("a", "do(walk,1)").core.shut_down("is aborted")
    node.keeper.send()
    again = start()
    again.core.shut_down("is aborted")
    again.keeper.send()
    assert not [one for one in again.published if isinstance(one, ActionsPreempted)]


def kept(journal, now=lambda: 0.0):
    """Return a core that has not begun, its keeper, and the released messages."""
    published = []
    keeper = Keeper(published.append, journal, now, lambda: 0.0)
    core = Core(PROGRAM, lambda: shortest(PROGRAM), keeper, CoreSettings(horizon_limit=8, search_timeout=0.0))
    keeper.attach(core)
    return core, keeper, published


def test_keeper_releases_all_messages_without_journal(tmp_path):
    core, keeper, published = kept(None)
    core.start()
    keeper.add("a", ClientGoal("do(", (1, 2)))
    keeper.keep()
    core.add_goal("a", "do(")
    assert published == []
    keeper.send()
    assert [(one.key, one.state) for one in published if isinstance(one, GoalChanged)] == [("a", GoalState.REJECTED)]
    assert (keeper.clients, keeper.fault) == ({}, "")
    keeper.close()


def test_keeper_reports_problems_of_the_journal(tmp_path):
    place, now = Journal(tmp_path, Header("run", "program")), [0.0]
    _, keeper, _ = kept(place, lambda: now[-1])
    assert keeper.fault == ""
    with room_for(0):
        keeper.add("a", ClientGoal("do(walk,1)", (1, 2)))
        keeper.keep()
        assert "disk I/O error" in keeper.fault
    now.append(folder.RETRY - 0.1)
    keeper.send()
    assert keeper.fault
    now.append(folder.RETRY)
    keeper.send()
    assert keeper.fault == ""
    assert place.read().state["client:a"] == {
        "text": "do(walk,1)",
        "stamp": [1, 2],
        "cancelled": False,
        "ending": None,
    }, "though nothing has happened"
    keeper.close()
