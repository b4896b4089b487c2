"""The incremental solver: optimization, bounds, stops and refused updates."""

import pytest
from plain_walk import program_text
from stream_play import play, solver_of

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, SolveOutcome, SolverError, parse_update


@pytest.mark.parametrize("models", [1, 0])
def test_optimizing_solver_accepts_answers_without_costs(models):
    solver = solver_of(
        "#external _request/2. #cumulative t. 1 { go(1..3,I,t) } 1 :- _request(I,t). :~ go(X,I,C). [X,I,C]#volatile t.",
        models=models,
    )
    assert [sorted(map(str, answer)) for answer in solver.solve().answers] == [[]]
    assert [sorted(map(str, answer)) for answer in play(solver, "#step 1.").answers] == [[]]
    requested = play(solver, "#step 2. _request(x,2).")
    assert [sorted(map(str, answer)) for answer in requested.answers] == [["_request(x,2)", "go(1,x,2)"]]


def test_solver_distinguishes_permanent_from_temporary_unsatisfiability():
    solver = solver_of("{ a }. #cumulative t. #external e(t). :- a, e(t). #volatile t.")
    assert play(solver, "#step 1 : 0. e(1). #volatile. :- not a.").outcome is SolveOutcome.UNSATISFIABLE
    assert play(solver, "#step 1 : 0.").outcome is SolveOutcome.SATISFIABLE
    result = play(solver, "#step 1. :- not e(1).")
    assert result.outcome is SolveOutcome.SATISFIABLE
    result = play(solver, "#step 1. :- e(1).")
    assert result.outcome is SolveOutcome.UNSATISFIABLE
    assert result.permanent
    assert result.horizon == 1


def test_redefinition_is_refused_without_changing_the_state():
    text = "#program cumulative(s).\n{ m(s) }.\np(s/4) :- m(s), s > 3.\n:- p(9).\n#program volatile(s).\n"
    solver = ReactiveSolver(ReactiveProgram.from_text(text, "f.lp"))
    play(solver, "#step 4.")
    with pytest.raises(SolverError) as caught:
        play(solver, "#step 5.")
    assert str(caught.value) == (
        "the update was refused: f.lp:3:1: redefinition: p(1) is defined by the rules of two steps "
        "(give the head the step, like p(t), or move the rule to base)"
    )
    assert play(solver, "#step 4.").horizon == 4


def test_stop_callback_ends_an_endless_search():
    solver = solver_of("#cumulative t. s(t). #volatile t. :- s(t).")
    asked = []

    def stopped():
        asked.append(solver.horizon)
        return len(asked) > 20

    result = solver.update(parse_update("#step 1. #endstep."), stopped)
    assert result.outcome is SolveOutcome.INTERRUPTED
    assert play(solver, "#step 1 : 0.").outcome is SolveOutcome.UNSATISFIABLE


def test_horizon_limit_refuses_later_steps():
    solver = solver_of(program_text(), horizon_limit=3)
    assert play(solver, "#step 3.").outcome is SolveOutcome.SATISFIABLE
    with pytest.raises(SolverError, match="step 4 is beyond the horizon limit 3"):
        play(solver, "#step 4.")
    assert solver.step == 3
    assert play(solver, "_request(0,3).").outcome is SolveOutcome.SATISFIABLE, (
        "an update without a step keeps the previous step"
    )
    assert solver.solve().outcome is SolveOutcome.SATISFIABLE
