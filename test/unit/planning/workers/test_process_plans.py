"""Plans and questions by way of a worker: as those of a solver in this process."""

import os
import signal
from dataclasses import replace

import pytest
from children import kill
from plain_walk import ONWARD, onward, program_text

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_atom, parse_update
from rosoclingo.planning.history import AdoptedPlan, Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers import process_solver
from rosoclingo.planning.workers.pool import WorkerPool

PLAIN = ReactiveProgram.from_text(program_text())
ASK = parse_update("#step 1. _request(3,1). #endstep.")


def asked(pool):
    """A solver that was asked, with a plan that idles for a cycle, and its first action."""
    solver = pool.solver()
    assert solver.improve() is None
    soon = solver.update(ASK)
    assert (solver.log.plan, soon.shortest) == (Plan.from_result(soon), False)
    (action,) = (one for one in solver.log.plan.actions if cycle_of(one) == 1)
    worse = Plan(solver.log.plan.delayed().actions | {action}, solver.log.plan.horizon + 1)
    solver.restore(solver.log.adopt(worse))
    return solver, worse, action


@pytest.mark.parametrize("event", [None, signal.SIGSTOP, signal.SIGKILL])
def test_worker_improves_the_plan_in_force(event):
    """One that was started since, too; a stop does not wait for it."""
    with WorkerPool(PLAIN, shortest=True, plan_time=0.0) as pool:
        solver, worse, action = asked(pool)
        if event is signal.SIGKILL:
            kill(pool)
        elif event is not None:
            os.kill(pool.pid, event)
        for _ in range(2):
            assert solver.improve(lambda: True) is None
        assert solver.log.plan == worse
        if event is signal.SIGSTOP:
            os.kill(pool.pid, signal.SIGCONT)
        while (result := solver.improve()) is not None:
            assert Plan.from_result(result) == solver.log.plan
        assert solver.log.plan.horizon == 3
        assert action in solver.log.plan.actions
        assert solver.update(parse_update(f"#step 2. :- not {action}. #endstep.")).horizon == 3


@pytest.mark.slow
def test_new_worker_begins_with_the_plan_in_force():
    with WorkerPool(PLAIN, shortest=True, plan_time=0.0) as pool:
        solver, worse, action = asked(pool)
        kill(pool)
        again = solver.update(parse_update(f"#step 2. :- not {action}. fail(1). #endstep."))
        assert Plan.from_result(again).rest(2).actions == worse.rest(2).actions


def test_incremental_solver_adopts_no_plan():
    """To find the actions among all atoms of an answer takes time."""
    with WorkerPool(PLAIN) as pool:
        solver = pool.solver()
        assert solver.update(ASK).answers == ReactiveSolver(PLAIN).update(ASK).answers != ()
        assert solver.log.plan is None


@pytest.fixture
def here():
    """A solver in this process."""
    return PlanSolver(ReactiveProgram.from_text(ONWARD), plan_time=60.0)


@pytest.fixture
def pool():
    with WorkerPool(ReactiveProgram.from_text(ONWARD), shortest=True, plan_time=60.0) as one:
        yield one


def from_now_on(result):
    """A result without the actions of the past, of which a worker sends the latest alone."""
    answers = [{one for one in answer if one.arguments[-1].number >= result.step} for answer in result.answers]
    return replace(result, answers=answers, statistics={})


@pytest.mark.slow
@pytest.mark.parametrize("between", [signal.SIGCONT, signal.SIGKILL])
def test_predicted_update_does_not_wait_for_the_worker(here, pool, between):
    last, solver = 32, pool.solver()
    ask = parse_update(f"#step 1 : 50. _request({last},1). #endstep.")
    first = here.update(ask)
    assert solver.update(ask) == first
    assert first.horizon == last
    os.kill(pool.pid, signal.SIGSTOP)
    for step in range(2, last):
        result = solver.update(onward(step, step - 1))
        assert result == here.update(onward(step, step - 1))
        assert (result.step, result.answers) == (step, first.answers)
    os.kill(pool.pid, between)
    if between == signal.SIGKILL:
        kill(pool)
    failed = onward(last, "no")
    assert from_now_on(solver.update(failed)) == from_now_on(here.update(failed))
    assert here.horizon > first.horizon
    assert solver.log.key == here.log.key


@pytest.mark.slow
def test_worker_puts_checkpoint_behind_predicted_updates(here, pool, monkeypatch):
    """A stop does not wait for it, and another worker reads it."""
    monkeypatch.setattr(process_solver, "LONG_PREDICTED", 3)
    solver = pool.solver()

    def length():
        return sum(not isinstance(one, AdoptedPlan) for one in solver.log.entries)

    ask = parse_update("#step 1 : 50. _request(9,1). #endstep.")
    assert solver.update(ask) == here.update(ask)
    for step in range(2, 9):
        assert solver.update(onward(step, step - 1)) == here.update(onward(step, step - 1))
        if step == 5:
            log = solver.log
            os.kill(pool.pid, signal.SIGSTOP)
            solver.compact(lambda: True)
            assert solver.log is log
            os.kill(pool.pid, signal.SIGCONT)
        if step in (3, 6):
            solver.compact(lambda: False)
            assert length() == (1 if step == 6 else 3)
        if step == 7:
            kill(pool)
    assert length() == 3, "the checkpoint and the updates since"
    failed = onward(9, "no")
    found, expected = solver.update(failed), here.update(failed)
    assert (found.outcome, found.horizon) == (expected.outcome, expected.horizon)


def test_worker_answers_what_would_be():
    text = "#external e/1.\n#program cumulative(t).\n:- e(1), e(2), not e(3).\n"
    here = PlanSolver(ReactiveProgram.from_text(text))
    update = parse_update('#step 2 : 1. e(1). e(2). e("3"). #end step.')
    assumable = frozenset(map(parse_atom, ["e(1)", "e(2)", 'e("3")']))
    with WorkerPool(ReactiveProgram.from_text(text), shortest=True) as pool:
        solver = pool.solver()
        solver.update(parse_update("#step 1 : 1. #end step."))
        here.update(parse_update("#step 1 : 1. #end step."))
        log = solver.log
        for disabled in (frozenset(), frozenset([parse_atom("e(1)")])):
            assert solver.inquire(update, assumable, disabled) == here.inquire(update, assumable, disabled)
        assert solver.inquire(update, assumable, frozenset()).core == assumable - {parse_atom('e("3")')}
        assert solver.log is log
