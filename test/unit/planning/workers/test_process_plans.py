"""Plans and questions by way of a solver's process: as those of a solver in this process."""

import os
import signal
from dataclasses import replace

import pytest
from children import kill
from plain_walk import program_text

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_atom, parse_update
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers import process_solver
from rosoclingo.planning.workers.pool import WorkerPool


@pytest.mark.slow
def test_plans_are_shortened_in_a_process_as_well():
    """A child that has read the log anew shortens the plan that the caller goes by; a stop ends that."""
    program = ReactiveProgram.from_text(program_text())
    with WorkerPool(program, shortest=True, oclingo_strings=False, plan_time=0.0) as process:
        solver = process.solver()
        assert solver.improve() is None
        solver.update(parse_update("#step 1. _request(3,1). #endstep."))
        (action,) = (one for one in solver.log.plan.actions if cycle_of(one) == 1)
        worse = Plan(solver.log.plan.later().actions | {action}, solver.log.plan.horizon + 1)
        solver.restore(solver.log.adopt(worse))
        kill(process)
        assert solver.improve(lambda: True) is None
        assert solver.log.plan == worse
        while (result := solver.improve()) is not None:
            assert Plan.in_result(result) == solver.log.plan
        assert solver.log.plan.horizon == 3
        assert action in solver.log.plan.actions
        assert solver.update(parse_update(f"#step 2. :- not {action}. #endstep.")).horizon == 3


def test_no_plan_is_kept_where_no_search_begins_with_one():
    """As in this process: to find the actions among all atoms of an answer takes time."""
    program, update = ReactiveProgram.from_text(program_text()), parse_update("#step 1. _request(3,1). #endstep.")
    here = ReactiveSolver(program)
    with WorkerPool(program) as process:
        there = process.solver()
        assert there.update(update).answers == here.update(update).answers != ()
        assert there.log.plan is None


def test_a_stop_of_what_shortens_a_plan_is_not_waited_for():
    """Whatever the process is at; what it finds then is not told, and it goes by the plan that is followed."""
    program = ReactiveProgram.from_text(program_text())
    with WorkerPool(program, shortest=True, oclingo_strings=False, plan_time=0.0) as process:
        solver = process.solver()
        solver.update(parse_update("#step 1. _request(3,1). #endstep."))
        (action,) = (one for one in solver.log.plan.actions if cycle_of(one) == 1)
        worse = Plan(solver.log.plan.later().actions | {action}, solver.log.plan.horizon + 1)
        solver.restore(solver.log.adopt(worse))
        os.kill(process.pid, signal.SIGSTOP)
        for _ in range(2):
            assert solver.improve(lambda: True) is None
        os.kill(process.pid, signal.SIGCONT)
        assert solver.log.plan == worse
        assert solver.improve().horizon == worse.horizon - 1


@pytest.mark.slow
def test_plans_soon_come_from_a_process_as_well():
    """A time for plans goes to the child, what is proven comes back, and a new child is told the last plan."""
    program = ReactiveProgram.from_text(program_text())
    options = {"shortest": True}
    ask = parse_update("#step 1. _request(3,1). _request(-2,1). #endstep.")
    with WorkerPool(program, plan_time=0.0, **options) as process:
        solver = process.solver()
        soon = solver.update(ask)
        assert not soon.shortest
        assert solver.log.plan == Plan.in_result(soon)
        (action,) = (one for one in Plan.in_result(soon).actions if cycle_of(one) == 1)
        worse = Plan(Plan.in_result(soon).later().actions | {action}, soon.horizon + 1)
        solver.restore(solver.log.adopt(worse))
        kill(process)
        again = solver.update(parse_update(f"#step 2. :- not {action}. fail(1). #endstep."))
        assert Plan.in_result(again).since(2).actions == worse.since(2).actions
    with WorkerPool(program, **options) as process:
        shortest = process.solver().update(ask)
        assert shortest.shortest
        assert shortest.horizon <= soon.horizon


WALK = """
#program base. at(0,0). #show _action_lib/3.
#program cumulative(t).
#external _request/2. #external _return/3.
{ _action_lib(go,X+1,t) } :- at(X,t-1), wanted(Y,t), X < Y.
at(X,t) :- _action_lib(go,X,t), not failed(t).
at(X,t) :- at(X,t-1), not moved(t).
moved(t) :- _action_lib(go,X,t), not failed(t).
failed(t) :- _action_lib(go,X,t), _return(go,Y,t), X != Y.
wanted(X,t) :- _request(X,t).
wanted(X,t) :- wanted(X,t-1).
#program volatile(t).
:- wanted(X,t), not at(X,t).
"""


def told(step, value):
    """The update that tells how the action before went."""
    done = f":- not _action_lib(go,{step - 1},{step - 1}). _return(go,{value},{step - 1})."
    return parse_update(f"#step {step} : 50. #closed {step - 1}. {done} #endstep.")


@pytest.mark.slow
@pytest.mark.parametrize("between", [signal.SIGCONT, signal.SIGKILL])
def test_what_was_foreseen_is_answered_whatever_the_process_is_at(between):
    """It reads all of that later, as another one does where it has ended."""
    program, last = ReactiveProgram.from_text(WALK), 32
    options = {"plan_time": 60.0}
    here = PlanSolver(program, **options)

    with WorkerPool(program, shortest=True, **options) as process:
        solver = process.solver()
        ask = parse_update(f"#step 1 : 50. _request({last},1). #endstep.")
        first = here.update(ask)
        assert solver.update(ask) == first
        assert first.horizon == last
        os.kill(process.pid, signal.SIGSTOP)
        for step in range(2, last):
            result = solver.update(told(step, step - 1))
            assert result == here.update(told(step, step - 1))
            assert (result.step, result.answers) == (step, first.answers)
        os.kill(process.pid, between)
        if between == signal.SIGKILL:
            kill(process)
        failed = told(last, "no")
        assert from_now_on(solver.update(failed)) == from_now_on(here.update(failed))
        assert here.horizon > first.horizon
        assert solver.log.key == here.log.key


def from_now_on(result):
    """A result less the actions of the past, of which a process sends the latest alone."""
    answers = [{one for one in answer if one.arguments[-1].number >= result.step} for answer in result.answers]
    return replace(result, answers=answers, statistics={})


@pytest.mark.slow
def test_a_long_log_of_what_was_foreseen_begins_anew_in_a_process_as_well(monkeypatch):
    """A stop is not waited for, and whoever takes over reads what was written down."""
    monkeypatch.setattr(process_solver, "LONG_PREDICTED", 3)
    program = ReactiveProgram.from_text(WALK)
    options = {"plan_time": 60.0}
    here = PlanSolver(program, **options)

    with WorkerPool(program, shortest=True, **options) as process:
        solver = process.solver()
        ask = parse_update("#step 1 : 50. _request(9,1). #endstep.")
        assert solver.update(ask) == here.update(ask)
        for step in range(2, 9):
            assert solver.update(told(step, step - 1)) == here.update(told(step, step - 1))
            if step == 5:
                log = solver.log
                os.kill(process.pid, signal.SIGSTOP)
                solver.shorten_log(lambda: True)
                assert solver.log is log
                os.kill(process.pid, signal.SIGCONT)
            if step in (3, 6):
                solver.shorten_log(lambda: False)
                assert len(solver.log.entries) == (1 if step == 6 else 3)
            if step == 7:
                kill(process)
        assert len(solver.log.entries) == 3, "the checkpoint and the updates since"
        failed = told(9, "no")
        found, expected = solver.update(failed), here.update(failed)
        assert (found.outcome, found.horizon) == (expected.outcome, expected.horizon)


def test_what_would_be_is_asked_of_the_process_as_well():
    text = "#external e/1.\n#program cumulative(t).\n:- e(1), e(2), not e(3).\n"
    here = PlanSolver(ReactiveProgram.from_text(text))
    update = parse_update('#step 2 : 1. e(1). e(2). e("3"). #end step.')
    doubted = frozenset(map(parse_atom, ["e(1)", "e(2)", 'e("3")']))
    with WorkerPool(ReactiveProgram.from_text(text), shortest=True) as process:
        solver = process.solver()
        solver.update(parse_update("#step 1 : 1. #end step."))
        here.update(parse_update("#step 1 : 1. #end step."))
        log = solver.log
        for untold in (frozenset(), frozenset([parse_atom("e(1)")])):
            assert solver.inquire(update, doubted, untold) == here.inquire(update, doubted, untold)
        assert solver.inquire(update, doubted, frozenset()).core == doubted - {parse_atom('e("3")')}
        assert solver.log is log
