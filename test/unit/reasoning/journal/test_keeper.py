"""Messages of the core leave once they are durable; each goal stays in the journal until its end is reported."""

import json

from core_driver import ERRANDS
from kept_node import PROGRAM, KeptCore

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.events import ActionsDispatched, ActionsPreempted, GoalChanged
from rosoclingo.reasoning.goals import GoalState, Outcome
from rosoclingo.reasoning.journal.keeper import Ending
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
    node.goal("a", "do(walk,1)").run().goal("b", "do(").run().succeed()
    ends = [
        event.state.value for event in node.published if isinstance(event, GoalChanged) and event.outcome is not None
    ]
    assert ends == ["rejected", "succeeded"]
    assert not node.keeper.clients


def test_keeper_holds_unconfirmed_end_until_it_expires(start):
    node = start()
    node.goal("a", "do(walk,1)").run()
    (action,) = node.core.awaited
    node.core.receive("hand", [f"_return({action.interface},{action.parameter},{action.cycle})"])
    while node.core.advance(1.0):
        node.keeper.send(keep_ends=True)
    assert any(isinstance(event, GoalChanged) and event.outcome is not None for event in node.published)
    again = start()
    assert again.keeper.clients["a"].ending == Ending(GoalState.SUCCEEDED, Outcome.SUCCEEDED, "do(walk,1) is met")
    again.keeper.forget(["a"])
    again.goal("b", "do(walk,2)").run()
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


def test_keeper_shutdown_cancels_each_action_under_way(start):
    program = ReactiveProgram.from_text(TOGETHER)
    node = start(program)
    node.core.add_goal("a", "do(walk,1)")
    node.goal("b", "do(run,2)").run()
    under_way = node.core.awaited
    assert len(under_way) == 2

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
    again.goal("c", "do(walk,3)").run().succeed()
    assert [one.outcome for one in again.published if isinstance(one, GoalChanged)][-1] is Outcome.SUCCEEDED


def test_keeper_releases_all_messages_without_journal():
    published = []
    node = KeptCore(published.append, None, PROGRAM, CoreSettings(horizon_limit=8, search_timeout=0.0))
    node.core.start()
    node.goal("a", "do(")
    assert published == []
    node.keeper.send()
    assert [(one.key, one.state) for one in published if isinstance(one, GoalChanged)] == [("a", GoalState.REJECTED)]
    assert (node.keeper.clients, node.keeper.fault) == ({}, "")
    node.keeper.close()
