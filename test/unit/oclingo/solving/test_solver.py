"""The reactive solver: what golden answers and properties don't cover."""

import time
from types import SimpleNamespace

import pytest
from stream_logs import cut

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, SolveOutcome, SolverError, parse_atom, parse_update
from rosoclingo.oclingo.solving import horizon_search as idling
from rosoclingo.oclingo.solving.assumptions import Search
from rosoclingo.oclingo.solving.grounding import Grounding
from rosoclingo.oclingo.solving.solver import SolveResult
from rosoclingo.oclingo.solving.stream_log import Plan

WALK = """
#program base.
at(0,0).
#program cumulative(t).
#external _request/2.
{ _action_lib(move,X,t) : X = (P-1;P+1), at(P,t-1) } 1.
at(X,t) :- _action_lib(move,X,t).
at(X,t) :- at(X,t-1), not moves(t).
moves(t) :- _action_lib(move,X,t).
wanted(X,t) :- _request(X,t).
wanted(X,t) :- wanted(X,t-1).
reached(X,t) :- wanted(X,t), at(X,t).
reached(X,t) :- reached(X,t-1).
#program volatile(t).
:- wanted(X,t), not reached(X,t).
"""


def solver_of(text, **options):
    return ReactiveSolver(ReactiveProgram.from_text(text), **options)


def play(solver, text):
    return solver.update(parse_update(text + " #endstep."))


def atoms(result):
    return sorted(map(str, result.answers[0]))


def plan(result):
    return [str(one) for one in sorted(result.answers[0]) if one.name == "_action_lib"]


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


@pytest.mark.parametrize("cycle", ["T+1", "1+T", "(T-1)+2", "2*T-T+1", "t+1"])
def test_no_action_beyond_the_horizon_however_its_cycle_is_written(cycle):
    text = f"#cumulative t. now(t). {{ _action_lib(go,x,{cycle}) }} :- now(T), T = t. #volatile t."
    solver = solver_of(text, shortest=True, models=0)
    play(solver, "#step 2 : 2. #volatile. :- not now(4).")
    assert solver.horizon == 4
    result = play(solver, "#step 2 : 0.")
    actions = {str(atom) for answer in result.answers for atom in answer if atom.name == "_action_lib"}
    assert actions == {"_action_lib(go,x,2)"}


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


def test_an_update_is_refused_as_a_whole():
    solver = solver_of("#cumulative t. #external e(t). #volatile t.", horizon_limit=5)
    play(solver, "#step 1. e(1).")
    with pytest.raises(SolverError, match="beyond the horizon limit 5"):
        play(solver, "#step 9. e(2).")
    assert atoms(play(solver, "#step 2.")) == ["e(1)"]


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


@pytest.mark.parametrize("options", [{}, {"shortest": True, "plan_time": 0.0}])
def test_what_an_answer_took_is_part_of_the_time_that_has_passed(options):
    solver = solver_of("#cumulative t. { a(t) }. #volatile t. :- t < 3.", **options)
    began, used = time.perf_counter(), time.process_time()
    for step in (1, 2, 3):
        seconds = play(solver, f"#step {step} : 9.").statistics
        assert 0.0 <= seconds["needed"] <= time.process_time() - used
        assert min(seconds["solve"], seconds["ground"]) >= 0.0
        assert seconds["solve"] + seconds["ground"] <= time.perf_counter() - began


def test_what_goes_on_improving_an_answer_was_not_needed_for_it(monkeypatch):
    """The time until there was an answer counts, whatever the clock shows at the end."""
    ended = SimpleNamespace(perf_counter=time.perf_counter, process_time=lambda: 100.0)
    monkeypatch.setattr("rosoclingo.oclingo.solving.solver.time", ended)
    monkeypatch.setattr("rosoclingo.oclingo.solving.plan_search.time", SimpleNamespace(process_time=lambda: 103.0))
    program = "#cumulative t. { a(t) }. #volatile t. :- t < 3."
    for options, needed in (({"plan_time": 9.0}, 3.0), ({}, 0.0)):
        solver = solver_of(program, shortest=True, **options)
        assert play(solver, "#step 1 : 9.").statistics["needed"] == needed


def test_the_plan_of_a_result_is_that_of_its_last_answer():
    answers = tuple(frozenset([parse_atom(f"_action_lib(go,{place},1)")]) for place in "ab")
    result = SolveResult(SolveOutcome.SATISFIABLE, answers, 4, 1, shortest=True)
    assert result.plan == Plan(answers[1], 4, shortest=True)
    assert SolveResult(SolveOutcome.UNSATISFIABLE, (), 4, 1).plan is None


def test_the_last_plan_is_known_after_an_update_without_an_answer():
    solver = solver_of(WALK, shortest=True)
    play(solver, "#step 1. _request(2,1).")
    plan = solver.log.plan
    assert len(plan.actions) == 2
    assert play(solver, "#step 2 : 0. #volatile. :- at(0,0).").outcome is SolveOutcome.UNSATISFIABLE
    assert solver.log.plan == plan


def test_interrupt_without_a_search_changes_nothing():
    solver = solver_of("a. #cumulative t. #volatile t.")
    solver.interrupt()
    assert solver.solve().outcome is SolveOutcome.SATISFIABLE


def test_plans_are_shortest_though_the_horizon_has_grown():
    solver = solver_of(WALK, shortest=True, horizon_limit=30)
    assert plan(play(solver, "#step 1. _request(4,1).")) == [f"_action_lib(move,{i},{i})" for i in range(1, 5)]
    grown = solver.horizon
    log = solver.log
    play(solver, "#step 2. _request(-4,2).")
    assert solver.horizon > grown
    solver.restore(log)
    assert solver.horizon == grown
    for one in ("_request(1,1)",):
        other = solver_of(WALK, shortest=True, horizon_limit=30)
        play(other, "#step 9.")
        other.close_cycle(9, [])
        assert plan(play(other, f"#step 1. {one}.")) == ["_action_lib(move,1,1)"]


def test_answers_speak_the_programs_words_alone():
    """What the solver adds to the program is not shown, also where steps lie beyond an answer's horizon."""
    solver = solver_of(WALK, shortest=True, horizon_limit=30)
    play(solver, "#step 1. _request(4,1).")
    found = play(solver, "#step 2. _request(1,2). :- not _action_lib(move,1,1).")
    assert solver.horizon > found.horizon
    assert [name for name in atoms(found) if name.startswith("__")] == []


def test_closed_cycles_hold_what_was_executed_and_nothing_else():
    solver = solver_of(WALK, shortest=True, horizon_limit=30)
    play(solver, "#step 1. _request(1,1).")
    solver.close_cycle(1, [parse_atom("_action_lib(move,-1,1)")])
    solver.close_cycle(2, [])
    result = play(solver, "#step 3. :- not _action_lib(move,-1,1).")
    assert plan(result) == ["_action_lib(move,-1,1)", "_action_lib(move,0,3)", "_action_lib(move,1,4)"]
    solver.restore(cut(solver))
    assert plan(solver.solve()) == plan(result)


def test_least_costs_come_alone():
    solver = solver_of(
        "1 { a ; b ; c }. #minimize { 2,a : a ; 1,b : b ; 1,c : c }. #cumulative t. #volatile t.", models=0
    )
    assert [sorted(map(str, answer)) for answer in sorted(play(solver, "#step 1.").answers, key=str)] in (
        [["b"], ["c"]],
        [["c"], ["b"]],
    )


FORCED = """
#program base.
at(0,0).
#program cumulative(t).
#external _request/2.
1 { _action_lib(move,X+1,t); _action_lib(move,X-1,t) } 1 :- at(X,t-1).
at(X,t) :- _action_lib(move,X,t).
wanted(X,t) :- _request(X,t).
wanted(X,t) :- wanted(X,t-1), not at(X,t-1).
#program volatile(t).
:- wanted(X,t), not at(X,t).
"""


@pytest.mark.parametrize(("program", "idles"), [(WALK, True), (FORCED, False)])
def test_steps_are_grounded_at_once_only_where_they_may_be_idle(program, idles):
    """A program that demands an action at every step has no short plan once more steps are grounded."""
    solver = solver_of(program, shortest=True, horizon_limit=30)
    solver.solve()
    assert idling.may_idle(solver.program, lambda: False) is idles
    answer = play(solver, "#step 1. _request(3,1).")
    assert plan(answer) == [f"_action_lib(move,{i},{i})" for i in range(1, 4)]
    assert solver.horizon == (9 if idles else 3)


@pytest.mark.parametrize("number", [1, 2])
def test_whether_steps_may_be_idle_stays_unknown_where_the_trial_was_ended(monkeypatch, number):
    searches = []

    class Ended(Grounding):
        def search(self, *arguments, **options):
            searches.append(arguments)
            return Search(None) if len(searches) == number else super().search(*arguments, **options)

    program = ReactiveProgram.from_text(WALK)
    monkeypatch.setattr(idling, "Grounding", Ended)
    assert not idling.may_idle(program, lambda: False)
    assert idling.may_idle(program, lambda: False), "it is tried again"


def test_a_base_that_cannot_be_ground_is_told_by_the_search():
    program = ReactiveProgram.from_text("{ p(1..3) }. :- #sum { 2147483647,X : p(X) } > 3. #program cumulative(t).")
    assert not idling.may_idle(program, lambda: False)
    with pytest.raises(SolverError, match="Integer overflow"):
        ReactiveSolver(program, shortest=True).solve()


@pytest.mark.parametrize("shortest", [True, False])
def test_answers_may_show_any_term(shortest):
    program = ReactiveProgram.from_text('p(3). p("s"). #show X : p(X). #cumulative t. _action_lib(a,b,t).')
    result = ReactiveSolver(program, shortest=shortest).update(parse_update("#step 1. #endstep."))
    assert {"3", '"s"'} <= set(map(str, result.answers[0]))
    assert {str(one) for one in result.plan.actions} == {"_action_lib(a,b,1)"}
