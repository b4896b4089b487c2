"""Directives about the past: ``#closed``, ``#over``, ``#withdraw``, ``#anew``."""

import pytest
from core_driver import ERRANDS

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, parse_update
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver


@pytest.fixture(params=["own", "process"])
def solver(request):
    program = ReactiveProgram.from_text(ERRANDS)
    if request.param == "own":
        yield PlanSolver(program)
        return
    with WorkerPool(program, shortest=True) as process:
        yield ProcessSolver(process)


def plan(result):
    assert result.outcome is SolveOutcome.SATISFIABLE
    return sorted(str(atom) for atom in result.answers[0] if atom.name == "_action_lib")


@pytest.mark.parametrize(
    "text",
    [
        "#closed 3.",
        "#closed 1..3.",
        "#over 7.",
        "#withdraw p(a,1).",
        "#withdraw -p.",
        "#anew.",
        "#closed 2.\n:- not a(2).",
    ],
)
def test_directives_about_the_past_are_parsed(text):
    update = parse_update(f"#step 4 : 5.\n{text}\n#end step.\n")
    assert str(update) == f"#step 4 : 5.\n{text}\n#end step.\n"


def test_closed_cycles_contain_only_committed_actions(solver):
    solver.update(parse_update("#step 1 : 9. _request(do(walk,1),2). #endstep."))
    text = "#step 4 : 9. #closed 1..3. :- not _action_lib(walk,1,2). _request(do(run,2),5). #endstep."
    assert plan(solver.update(parse_update(text))) == ["_action_lib(run,2,4)", "_action_lib(walk,1,2)"]


def test_closed_directive_ignores_future_cycles(solver):
    text = "#step 2 : 9. #closed 1..999999999. _request(do(run,2),3). #endstep."
    assert solver.update(parse_update(text)).outcome is SolveOutcome.SATISFIABLE
    assert solver.step == 2


def test_withdrawn_facts_and_commitments_have_no_effect(solver):
    solver.update(parse_update("#step 1 : 9. _request(do(walk,1),2). _seen(ball). #endstep."))
    solver.update(
        parse_update("#step 2 : 9. #closed 1. :- not _action_lib(walk,1,1). _return(walk,failed,1). #endstep.")
    )
    solver.update(parse_update("#step 3 : 9. #withdraw _return(walk,failed,1). #closed 2. #endstep."))
    assert plan(solver.update(parse_update("#step 4 : 9. #endstep."))) == ["_action_lib(walk,1,1)"]
    withdrawn = "#step 5 : 9. #withdraw _request(do(walk,1),2). #withdraw _action_lib(walk,1,1). #endstep."
    assert plan(solver.update(parse_update(withdrawn))) == []


def test_anew_directive_discards_earlier_updates(solver):
    solver.update(parse_update("#step 1 : 9. _request(do(never,1),2). #endstep."))
    assert plan(solver.update(parse_update("#step 3 : 9. #anew. #closed 1..2. #endstep."))) == []
    assert plan(solver.update(parse_update("#step 4 : 9. _request(do(walk,2),5). #endstep."))) == [
        "_action_lib(walk,2,4)"
    ]


@pytest.mark.slow
def test_facts_of_steps_over_are_ignored(solver):
    for step in range(1, 140):
        solver.update(parse_update(f"#step {step} : 5. #closed {step - 1}. #over {max(0, step - 10)}. #endstep."))
    assert solver.log.keep_from == 129
    result = solver.update(parse_update("#step 140 : 5. _return(walk,1,3). #endstep."))
    assert result.outcome is SolveOutcome.SATISFIABLE
    (warning,) = result.warnings
    assert warning.startswith("Head _return(walk,1,3) comes too late")
