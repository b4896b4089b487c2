"""The incremental solver: optimization, bounds, stops and refused updates."""

import pytest
from plain_walk import program_text
from stream_play import SOLVERS, play, solver_of

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, SolveOutcome, SolverError, parse_update
from rosoclingo.planning.history import Plan


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


def test_optimizing_solver_returns_only_optimal_answers():
    solver = solver_of(
        "1 { a ; b ; c }. #minimize { 2,a : a ; 1,b : b ; 1,c : c }. #cumulative t. #volatile t.", models=0
    )
    assert [sorted(map(str, answer)) for answer in sorted(play(solver, "#step 1.").answers, key=str)] in (
        [["b"], ["c"]],
        [["c"], ["b"]],
    )


@SOLVERS
def test_solver_answers_can_show_any_term(kind):
    solver = solver_of('p(3). p("s"). #show X : p(X). #cumulative t. _action_lib(a,b,t).', kind)
    result = play(solver, "#step 1.")
    assert {"3", '"s"'} <= set(map(str, result.answers[0]))
    assert {str(one) for one in Plan.from_result(result).actions} == {"_action_lib(a,b,1)"}


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


def test_permanently_unsatisfiable_result_has_the_bound_as_horizon():
    """As in oClingo, which grows up to the bound; the solver does not ground these steps."""
    solver = solver_of("{ a }. #cumulative t. #external e(t). #volatile t.")
    result = play(solver, "#step 1 : 6. :- not a. :- a.")
    assert (result.horizon, result.permanent) == (7, True)
    result = play(solver, "#step 3 : 5.")
    assert (result.horizon, result.permanent) == (8, True)
    assert solver.horizon < 7
    solver = solver_of("{ a }. #cumulative t. #volatile t. :- a. :- not a.", horizon_limit=9)
    assert play(solver, "#step 3 : 50.").horizon == 9


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


def test_later_update_cannot_add_a_rule_for_a_fact():
    warning = "Head g(x) has not been declared external. The entire rule will be ignored."
    solver = solver_of("#base. { a }. #external g/1. #cumulative t. h(t) :- g(x). #volatile t.")
    assert play(solver, "#step 1. g(x). g(x) :- a.").warnings == ()
    assert play(solver, "#step 2. g(x).").warnings == (), "a fact that is already true is no error"
    assert play(solver, "#step 3. g(x) :- a.").warnings == (warning,)


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
