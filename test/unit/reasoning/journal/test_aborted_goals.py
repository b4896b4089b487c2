"""A core that resumes from its journal can still explain aborted goals."""

import pytest
from core_programs import rooms
from kept_node import PROGRAM

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.explaining.explainer import explain


def ask(node, **texts):
    """Send goals and let the core act until it needs a result from the world."""
    for key, text in texts.items():
        node.core.add_goal(key, text)
    return node.run()


def explained(core, name):
    """Return the explanation of an aborted goal."""
    found = core.keeper.aborted_goals.find(name)
    return explain(PROGRAM, found.stream)


@pytest.mark.slow
def test_resumed_core_explains_aborted_goals_like_its_predecessor(start):
    first = ask(start(horizon_limit=4), a="do(walk,1)", b="do(never,2)")
    (walk,) = first.core.awaited
    first.core.receive("hand", [f"_return(walk,1,{walk.cycle})"])
    ask(first, c="do(never,3)")
    reasons = {name: explained(first, name) for name in ("b", "do(never, 2)", "2", "c")}
    assert reasons["b"].rules
    assert "do(never,2)" in " ".join(fact.text for fact in reasons["b"].stream_facts)
    again = start(horizon_limit=4)
    assert [str(term) for term in again.keeper.aborted_goals.terms] == ["do(never,2)", "do(never,3)"]
    assert {name: explained(again, name) for name in reasons} == reasons
    assert again.keeper.aborted_goals.find("walk") is None
    ask(again, d="do(never,4)")
    third = start(horizon_limit=4)
    assert [str(term) for term in third.keeper.aborted_goals.terms] == [f"do(never,{number})" for number in (2, 3, 4)]
    assert explained(third, "3") == reasons["c"]


def test_resumed_core_names_facts_of_its_predecessor_as_reasons(start):
    program = ReactiveProgram.from_text(rooms(doors=[("hall", "d")]))
    first = start(program)
    first.core.receive("sensor", ["_shut(d)"])
    first.run()
    again = ask(start(program), a="reach(hall,1)")
    end = next(one for one in again.published if getattr(one, "outcome", None) is not None)
    assert end.message == "reach(hall,1) cannot be met since _shut(d) was reported in cycle 1"
