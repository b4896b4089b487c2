"""Idling: whether answers of a program stay answers if more steps are grounded."""

import pytest
from stream_play import WALK, plan, planner_of, play

from rosoclingo.oclingo import ReactiveProgram, SolverError
from rosoclingo.planning import idling
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.idling import may_idle
from rosoclingo.planning.question import UNKNOWN
from rosoclingo.planning.solver import PlanSolver

#: The same walk, with a mandatory action at each step.
FORCED = WALK.replace("{ _action_lib", "1 { _action_lib")


def never():
    return False


@pytest.mark.parametrize(
    ("rule", "idle"),
    [("", True), (":- t = 1.", False), (":- t = 2.", False), (":- t = 4.", False), (":- t = 5.", True)],
)
def test_may_idle_tries_some_steps_once(rule, idle, monkeypatch):
    program = ReactiveProgram.from_text(f"#program cumulative(t). {{ a(t) }}. {rule} #program volatile(t).")
    assert may_idle(program, never) is idle
    monkeypatch.setattr(idling, "Grounding", None)
    assert may_idle(program, never) is idle


@pytest.mark.parametrize("number", [1, 2])
def test_may_idle_tries_again_after_a_stop(monkeypatch, number):
    asked, ask = [], Grounding.ask

    def stopped_once(grounding, question, stopped):
        asked.append(question)
        return UNKNOWN if len(asked) == number else ask(grounding, question, stopped)

    monkeypatch.setattr(Grounding, "ask", stopped_once)
    program = ReactiveProgram.from_text(WALK)
    assert [may_idle(program, never) for _ in range(2)] == [False, True]


def test_may_idle_leaves_errors_to_the_search():
    program = ReactiveProgram.from_text("{ p(1..3) }. :- #sum { 2147483647,X : p(X) } > 3. #program cumulative(t).")
    assert not may_idle(program, never)
    with pytest.raises(SolverError, match="Integer overflow"):
        PlanSolver(program).solve()


@pytest.mark.parametrize(("program", "horizon"), [(WALK, 9), (FORCED, 3)])
def test_steps_are_ground_in_blocks_only_if_idling(program, horizon):
    """A program with mandatory actions has no short plan once more steps are grounded."""
    solver = planner_of(program, horizon_limit=30)
    solver.solve()
    answer = play(solver, "#step 1. _request(3,1).")
    assert plan(answer) == [f"_action_lib(move,{i},{i})" for i in range(1, 4)]
    assert solver.horizon == horizon
