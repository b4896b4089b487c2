"""The incremental solver: what golden answers and properties don't cover."""

import time

import pytest
from stream_play import SOLVERS, atoms, play, solver_of

from rosoclingo.oclingo import SolveOutcome, SolverError, parse_update
from rosoclingo.planning.history import Plan


@pytest.fixture
def open_external():
    return solver_of("#external e/1. a(X) :- e(X). #cumulative t. b(X,t) :- e(X). #volatile t.")


def test_open_external_reaches_base_and_past_steps(open_external):
    play(open_external, "#step 3.")
    assert atoms(play(open_external, "e(new(thing)).")) == [
        "a(new(thing))",
        "b(new(thing),1)",
        "b(new(thing),2)",
        "b(new(thing),3)",
        "e(new(thing))",
    ]


def test_lapsing_definitions_leave_externals_open():
    solver = solver_of("#cumulative t. #external e(t). c(t) :- e(t). #volatile t.")
    assert atoms(play(solver, "#step 1. #volatile. e(1).")) == ["c(1)", "e(1)"]
    assert atoms(play(solver, "#assert : x. e(1).")) == ["c(1)", "e(1)"]
    retracted = play(solver, "#retract : x.")
    assert (atoms(retracted), retracted.warnings) == ([], ())
    assert atoms(play(solver, "e(1).")) == ["c(1)", "e(1)"]


def test_ignored_heads_are_warned_of_in_oclingos_words():
    solver = solver_of("p. #cumulative t. #external e(t). { m(t) }. #volatile t.")
    result = play(solver, "#step 2. p. m(1). e(0). e(5) :- m(1). ")
    words = "Head {} has not been declared external. The entire rule will be ignored."
    assert list(result.warnings) == [words.format(head) for head in ("m(1)", "e(0)")]
    assert play(solver, "#retract : z.").warnings == ("Term z has not been asserted. The retraction is ignored.",)


@pytest.mark.parametrize("section", ["", "#volatile. ", "#assert : x. "])
def test_what_says_nothing_defines_nothing(section):
    """As in oClingo: a rule with its own head in its body leaves that open."""
    solver = solver_of("#cumulative t. #external e(t). c(t) :- e(t). #volatile t.")
    result = play(solver, f"#step 1. {section}e(1) :- e(1). e(1) :- not e(1), e(1).")
    assert (atoms(result), result.warnings) == ([], ())
    result = play(solver, "#step 2. e(1).")
    assert (atoms(result), result.warnings) == (["c(1)", "e(1)"], ())
    result = play(solver, "#step 3. e(1) :- not e(2).")
    assert list(result.warnings) == ["Head e(1) has not been declared external. The entire rule will be ignored."]


def test_a_fact_told_before_its_step():
    solver = solver_of("#cumulative t. #external e(t). c(t) :- e(t). #volatile t.")
    assert atoms(play(solver, "#step 1. e(3). #volatile. e(2).")) == []
    assert atoms(play(solver, "#step 3.")) == ["c(3)", "e(3)"]


def test_forget_of_the_program():
    solver = solver_of("#cumulative t. #external e(t). #forget t : t-1. #volatile t.")
    result = play(solver, "#step 3. e(2). e(3).")
    assert atoms(result) == ["e(2)", "e(3)"]
    assert not result.warnings
    result = play(solver, "#step 4. e(1). e(3).")
    assert atoms(result) == ["e(2)", "e(3)"]
    assert "Head e(1)" in result.warnings[0]


def test_a_step_cannot_forget_what_it_declares_itself():
    """As in oClingo: what is forgotten is looked up before the step's own externals are known."""
    solver = solver_of("#cumulative t. #external e(t). #forget t : t. #volatile t.")
    play(solver, "#step 2.")
    assert atoms(play(solver, "#step 2. e(2).")) == ["e(2)"]


def test_forget_in_an_update_comes_after_its_statements():
    solver = solver_of("#cumulative t. #external e(t). #volatile t.")
    assert atoms(play(solver, "#step 2. #forget 1..2. e(1).")) == ["e(1)"]
    result = play(solver, "#step 2. e(2).")
    assert atoms(result) == ["e(1)"]
    assert "Head e(2)" in result.warnings[0]


def test_volatile_for_no_step_is_plain_volatile():
    solver = solver_of("{ a }. #cumulative t. #volatile t. :- t < 3.", models=0)
    assert [sorted(map(str, one)) for one in play(solver, "#step 1. #volatile : 0. :- a.").answers] == [[]]
    assert len(play(solver, "#step 1.").answers) == 2


def test_a_loop_over_steps_supports_nothing():
    solver = solver_of("#cumulative t. #external e(t). d(t) :- e(t). c(t) :- d(t). #volatile t.", models=0)
    play(solver, "#step 1.")
    play(solver, "#volatile. e(1) :- c(1).")
    assert [sorted(map(str, answer)) for answer in play(solver, "e(1) :- d(1).").answers] == [[]]


@pytest.mark.parametrize("models", [1, 0])
def test_a_program_that_optimizes_has_answers_before_there_is_anything_to_optimize(models):
    solver = solver_of(
        "#external _request/2. #cumulative t. 1 { go(1..3,I,t) } 1 :- _request(I,t). :~ go(X,I,C). [X,I,C]#volatile t.",
        models=models,
    )
    assert [sorted(map(str, answer)) for answer in solver.solve().answers] == [[]]
    assert [sorted(map(str, answer)) for answer in play(solver, "#step 1.").answers] == [[]]
    told = play(solver, "#step 2. _request(x,2).")
    assert [sorted(map(str, answer)) for answer in told.answers] == [["_request(x,2)", "go(1,x,2)"]]


def test_contrary_atoms_exclude_each_other():
    solver = solver_of("{ x }. #cumulative t. s(t). #volatile t.", models=0)
    assert len(play(solver, "#step 1.").answers) == 2
    assert [sorted(map(str, a)) for a in play(solver, "-x.").answers] == [["-x", "s(1)"]]


def test_unsatisfiable_for_good_and_not():
    solver = solver_of("{ a }. #cumulative t. #external e(t). :- a, e(t). #volatile t.")
    assert play(solver, "#step 1 : 0. e(1). #volatile. :- not a.").outcome is SolveOutcome.UNSATISFIABLE
    assert play(solver, "#step 1 : 0.").outcome is SolveOutcome.SATISFIABLE
    result = play(solver, "#step 1. :- not e(1).")
    assert result.outcome is SolveOutcome.SATISFIABLE
    result = play(solver, "#step 1. :- e(1).")
    assert result.outcome is SolveOutcome.UNSATISFIABLE
    assert result.permanent
    assert result.horizon == 1


def test_what_is_unsatisfiable_for_good_names_the_bound():
    """As oClingo, which grows up to it; what was grounded is not more for that."""
    solver = solver_of("{ a }. #cumulative t. #external e(t). #volatile t.")
    result = play(solver, "#step 1 : 6. :- not a. :- a.")
    assert (result.horizon, result.permanent) == (7, True)
    result = play(solver, "#step 3 : 5.")
    assert (result.horizon, result.permanent) == (8, True)
    assert solver.horizon < 7
    solver = solver_of("{ a }. #cumulative t. #volatile t. :- a. :- not a.", horizon_limit=9)
    assert play(solver, "#step 3 : 50.").horizon == 9


def test_redefinition_at_run_time_is_refused_and_the_state_kept():
    solver = solver_of("#cumulative t. { m(t) }. p(t/4) :- m(t), t > 3. #volatile t.")
    play(solver, "#step 4.")
    with pytest.raises(SolverError, match=r"redefinition.*p\(1\).*give the head the step"):
        play(solver, "#step 5.")
    assert play(solver, "#step 4.").horizon == 4


def test_stopping():
    solver = solver_of("#cumulative t. s(t). #volatile t. :- s(t).")
    asked = []

    def stopped():
        asked.append(solver.horizon)
        return len(asked) > 20

    result = solver.update(parse_update("#step 1. #endstep."), stopped)
    assert result.outcome is SolveOutcome.INTERRUPTED
    assert play(solver, "#step 1 : 0.").outcome is SolveOutcome.UNSATISFIABLE


@SOLVERS
def test_statistics_lie_within_the_time_that_has_passed(kind):
    solver = solver_of("#cumulative t. { a(t) }. #volatile t. :- t < 3.", kind)
    began, used = time.perf_counter(), time.process_time()
    for step in (1, 2, 3):
        seconds = play(solver, f"#step {step} : 9.").statistics
        assert 0.0 <= seconds["needed"] <= time.process_time() - used
        assert min(seconds["solve"], seconds["ground"]) >= 0.0
        assert seconds["solve"] + seconds["ground"] <= time.perf_counter() - began


def test_least_costs_come_alone():
    solver = solver_of(
        "1 { a ; b ; c }. #minimize { 2,a : a ; 1,b : b ; 1,c : c }. #cumulative t. #volatile t.", models=0
    )
    assert [sorted(map(str, answer)) for answer in sorted(play(solver, "#step 1.").answers, key=str)] in (
        [["b"], ["c"]],
        [["c"], ["b"]],
    )


@SOLVERS
def test_answers_can_show_any_term(kind):
    solver = solver_of('p(3). p("s"). #show X : p(X). #cumulative t. _action_lib(a,b,t).', kind)
    result = play(solver, "#step 1.")
    assert {"3", '"s"'} <= set(map(str, result.answers[0]))
    assert {str(one) for one in Plan.from_result(result).actions} == {"_action_lib(a,b,1)"}
