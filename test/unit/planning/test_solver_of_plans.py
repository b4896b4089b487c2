"""The solver of plans: what properties and its parts' own tests don't cover."""

import time
from types import SimpleNamespace

import pytest
from stream_logs import copied, cut
from stream_play import WALK, atoms, plan, planner_of, play

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, SolverError, SolveResult, parse_atom
from rosoclingo.planning import idling
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import Plan
from rosoclingo.planning.question import UNKNOWN
from rosoclingo.planning.solver import PlanSolver


@pytest.mark.parametrize("cycle", ["T+1", "1+T", "(T-1)+2", "2*T-T+1", "t+1"])
def test_no_action_beyond_the_horizon_however_its_cycle_is_written(cycle):
    text = f"#cumulative t. now(t). {{ _action_lib(go,x,{cycle}) }} :- now(T), T = t. #volatile t."
    solver = planner_of(text, models=0)
    play(solver, "#step 2 : 2. #volatile. :- not now(4).")
    assert solver.horizon == 4
    result = play(solver, "#step 2 : 0.")
    actions = {str(atom) for answer in result.answers for atom in answer if atom.name == "_action_lib"}
    assert actions == {"_action_lib(go,x,2)"}


def test_what_goes_on_improving_an_answer_was_not_needed_for_it(monkeypatch):
    """The time until there was an answer counts, whatever the clock shows at the end."""
    ended = SimpleNamespace(perf_counter=time.perf_counter, process_time=lambda: 100.0)
    monkeypatch.setattr("rosoclingo.planning.solver.time", ended)
    monkeypatch.setattr("rosoclingo.planning.strategies.soon.time", SimpleNamespace(process_time=lambda: 103.0))
    program = "#cumulative t. { a(t) }. #volatile t. :- t < 3."
    for options, needed in (({"plan_time": 9.0}, 3.0), ({}, 0.0)):
        solver = planner_of(program, **options)
        assert play(solver, "#step 1 : 9.").statistics["needed"] == needed


def test_the_plan_of_a_result_is_that_of_its_last_answer():
    answers = tuple(frozenset([parse_atom(f"_action_lib(go,{place},1)")]) for place in "ab")
    result = SolveResult(SolveOutcome.SATISFIABLE, answers, 4, 1, shortest=True)
    assert Plan.in_result(result) == Plan(answers[1], 4, shortest=True)
    assert Plan.in_result(SolveResult(SolveOutcome.UNSATISFIABLE, (), 4, 1)) is None


def test_the_last_plan_is_known_after_an_update_without_an_answer():
    solver = planner_of(WALK)
    play(solver, "#step 1. _request(2,1).")
    plan = solver.log.plan
    assert len(plan.actions) == 2
    assert play(solver, "#step 2 : 0. #volatile. :- at(0,0).").outcome is SolveOutcome.UNSATISFIABLE
    assert solver.log.plan == plan


def test_plans_are_shortest_though_the_horizon_has_grown():
    solver = planner_of(WALK, horizon_limit=30)
    assert plan(play(solver, "#step 1. _request(4,1).")) == [f"_action_lib(move,{i},{i})" for i in range(1, 5)]
    grown = solver.horizon
    log = solver.log
    play(solver, "#step 2. _request(-4,2).")
    assert solver.horizon > grown
    solver.restore(log)
    assert solver.horizon == grown
    other = planner_of(WALK, horizon_limit=30)
    play(other, "#step 9.")
    other.close_cycle(9, [])
    assert plan(play(other, "#step 1. _request(1,1).")) == ["_action_lib(move,1,1)"]


def test_answers_speak_the_programs_words_alone():
    """What the solver adds to the program is not shown, also where steps lie beyond an answer's horizon."""
    solver = planner_of(WALK, horizon_limit=30)
    play(solver, "#step 1. _request(4,1).")
    found = play(solver, "#step 2. _request(1,2). :- not _action_lib(move,1,1).")
    assert solver.horizon > found.horizon
    assert [name for name in atoms(found) if name.startswith("__")] == []


def test_closed_cycles_hold_what_was_executed_and_nothing_else():
    solver = planner_of(WALK, horizon_limit=30)
    play(solver, "#step 1. _request(1,1).")
    solver.close_cycle(1, [parse_atom("_action_lib(move,-1,1)")])
    solver.close_cycle(2, [])
    result = play(solver, "#step 3. :- not _action_lib(move,-1,1).")
    assert plan(result) == ["_action_lib(move,-1,1)", "_action_lib(move,0,3)", "_action_lib(move,1,4)"]
    solver.restore(cut(solver))
    assert plan(solver.solve()) == plan(result)


IGNORED = "Head {} has not been declared external. The entire rule will be ignored."

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
    solver = planner_of(program, horizon_limit=30)
    solver.solve()
    assert idling.may_idle(solver.program, lambda: False) is idles
    answer = play(solver, "#step 1. _request(3,1).")
    assert plan(answer) == [f"_action_lib(move,{i},{i})" for i in range(1, 4)]
    assert solver.horizon == (9 if idles else 3)


@pytest.mark.parametrize("number", [1, 2])
def test_a_stopped_trial_leaves_it_open_whether_steps_may_be_idle(monkeypatch, number):
    asked = []

    class Ended(Grounding):
        def ask(self, question, stopped):
            asked.append(question)
            return UNKNOWN if len(asked) == number else super().ask(question, stopped)

    program = ReactiveProgram.from_text(WALK)
    monkeypatch.setattr(idling, "Grounding", Ended)
    assert not idling.may_idle(program, lambda: False)
    assert idling.may_idle(program, lambda: False), "it is tried again"


def test_a_base_that_cannot_be_ground_is_told_by_the_search():
    program = ReactiveProgram.from_text("{ p(1..3) }. :- #sum { 2147483647,X : p(X) } > 3. #program cumulative(t).")
    assert not idling.may_idle(program, lambda: False)
    with pytest.raises(SolverError, match="Integer overflow"):
        PlanSolver(program).solve()


def test_returns_of_a_cycle_are_closed_with_the_next_cycle():
    solver = planner_of("#cumulative t. #external _return(go,x,t). c(t) :- _return(go,x,t). #volatile t.")
    play(solver, "#step 3.")
    for cycle in (1, 2, 3):
        solver.close_cycle(cycle, [])
    late = play(solver, "_return(go,x,2). _return(go,x,3).")
    assert late.warnings == (IGNORED.format("_return(go,x,2)"),)
    assert atoms(late) == ["_return(go,x,3)", "c(3)"]


def test_what_was_executed_may_be_given_in_any_way():
    solver = planner_of("#cumulative t. { _action_lib(go,(x;y),t) }. #volatile t.", models=0)
    play(solver, "#step 1.")
    solver.close_cycle(1, iter([parse_atom("_action_lib(go,x,1)")]))
    for _ in range(2):
        answers = play(solver, "#step 1. :- not _action_lib(go,x,1).").answers
        assert [sorted(map(str, answer)) for answer in answers] == [["_action_lib(go,x,1)"]]
        solver.restore(cut(solver))


def test_results_tell_the_last_horizon_searched():
    solver = planner_of(WALK)
    assert play(solver, "#step 1 : 2. _request(8,1).").horizon == 3, "the last one that was searched"
    result = play(solver, "#step 1 : 9.")
    assert (result.outcome, result.horizon) == (SolveOutcome.SATISFIABLE, 8)
    result = play(solver, "#step 2 : 9. #volatile. :- not at(8,8).")
    assert result.horizon == 8
    assert solver.horizon >= 8


@pytest.mark.parametrize("cycle", ["t-2", "t-1", "t", "t+1", "t+2"])
def test_later_steps_bring_no_action_of_a_closed_cycle(cycle):
    solver = planner_of(f"#cumulative t. {{ _action_lib(go,x,{cycle}) }}. #volatile t.", models=0)
    solver.close_cycle(3, [])
    result = play(solver, "#step 5.")
    assert len(result.answers) > 1
    assert not any(parse_atom("_action_lib(go,x,3)") in answer for answer in result.answers)


def test_facts_withdrawn_from_a_history_were_never_told():
    solver = planner_of("{ a }. #cumulative t. #external e(t). c(t) :- e(t). #volatile t.")
    play(solver, "#step 1. :- a. e(1).")
    play(solver, "#step 2. e(2).")
    solver.restore(solver.log.without(frozenset([parse_atom("e(1)")])))
    assert atoms(solver.solve()) == ["c(2)", "e(2)"]


def test_readers_of_a_history_ground_as_much_as_its_writer():
    solver = planner_of("#cumulative t. p(t). #volatile t. :- t < 5.")
    found = play(solver, "#step 1.")
    reader = PlanSolver(solver.program)
    reader.restore(copied(solver.log))
    assert reader.horizon == reader.snapshot.horizon == solver.horizon >= 5
    assert atoms(reader.solve()) == atoms(found)
