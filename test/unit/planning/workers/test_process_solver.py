"""Process solvers: they answer as a solver in this process, and prefetch answers."""

import os
import signal
from dataclasses import replace

import pytest
from children import ended, kill, wait_until_prepared
from plain_walk import RESTING, onward

from rosoclingo.oclingo import ReactiveProgram, SolverError, parse_atom, parse_update
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver

PROGRAM = ReactiveProgram.from_text(RESTING)
ASK = parse_update("#step 1 : 50. _request(5,1). #endstep.")
FAILED = onward(2, "no")
#: The first action failed and was repeated.
AGAIN = onward(3, "no", place=1)


def pool_of(program=PROGRAM, **options):
    return WorkerPool(program, **{"shortest": True, "plan_time": 60.0, **options})


@pytest.fixture
def here():
    """Return a solver in this process that has answered ASK."""
    one = PlanSolver(PROGRAM, plan_time=60.0)
    one.update(ASK)
    return one


@pytest.fixture(scope="module")
def pool():
    """Share a pool between tests, as workers take long to start."""
    with pool_of(standby=True) as one:
        yield one


@pytest.fixture
def solver(pool):
    """Return a process solver that has answered ASK; the standby is idle."""
    one = ProcessSolver(pool)
    one.update(ASK)
    wait_until_prepared(pool)
    return one


# ---- Prefetching -----------------------------------------------------------------------------------------------------


UPDATES = {
    "success": onward(2, 1),
    "failure": FAILED,
    "other": onward(2, "other"),
    "repeated": AGAIN,
    "second": onward(3, 2),
    "later": onward(4, "no"),
}


def follow(script, here, pool, solver):
    """Execute a script such as "prefetch failure, wait, update failure"; return who is active then.

    The update "later" is prefetched in case it follows two successes. All answers are those of the solver ``here``.
    """
    names = {pool.pid: "worker", pool.standby_pid: "standby"}
    for verb, what in (f"{step} ".split(" ", 1) for step in script.split(", ")):
        update, worked = UPDATES.get(what.strip()), pool.cpu_time
        if verb == "prefetch":
            assert solver.prefetch(update, [UPDATES["success"], UPDATES["second"]] if update.step == 4 else ())
        elif verb == "wait":
            wait_until_prepared(pool)
        elif verb == "lose":
            pid = pool.standby_pid if what.strip() == "standby" else pool.pid
            os.kill(pid, signal.SIGKILL)
            assert ended(pid)
        elif verb in ("has", "lacks"):
            assert solver.has_prefetched(update) == (verb == "has")
        else:
            assert solver.update(update) == here.update(update)
            assert (solver.log.key, solver.log.plan) == (here.log.key, here.log.plan)
            assert pool.cpu_time >= worked or "lose" in script
    return names.get(pool.pid, "new")


@pytest.mark.sampled(4)
@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("script", "active"),
    [
        ("lacks failure, prefetch failure, wait, has failure, lacks other, update failure, update repeated", "standby"),
        ("prefetch failure, wait, update other", "worker"),
        # after predicted updates
        ("prefetch later, wait, update success, update second, update later", "standby"),
        # lost workers
        ("prefetch failure, wait, lose standby, lacks failure, prefetch failure, update failure", "new"),
        ("prefetch failure, lose worker, update other", "standby"),
    ],
)
def test_prefetched_answer_is_used_for_its_update_only(here, pool, solver, script, active):
    """The standby takes over with it, even if it is still searching; a lost worker costs only time."""
    assert follow(script, here, pool, solver) == active


@pytest.mark.slow
def test_prefetched_update_is_refused_when_it_comes():
    with pool_of(horizon_limit=3, standby=True) as pool:
        solver = ProcessSolver(pool)
        solver.update(parse_update("#step 1 : 50. _request(1,1). #endstep."))
        far = parse_update("#step 9 : 50. #endstep.")
        solver.prefetch(far)
        wait_until_prepared(pool)
        with pytest.raises(SolverError, match="beyond the horizon limit"):
            solver.update(far)
        assert solver.update(onward(2, "1")).step == 2


# ---- Predicted updates, improvements and hypothetical questions ------------------------------------------------------


@pytest.fixture
def alone():
    """Yield a pool without a standby."""
    with pool_of() as one:
        yield one


def from_now_on(result):
    """Return the result without past actions, as a worker sends only the latest."""
    answers = [{one for one in answer if one.arguments[-1].number >= result.step} for answer in result.answers]
    return replace(result, answers=answers, statistics={})


@pytest.mark.slow
def test_predicted_update_does_not_wait_for_the_worker(alone):
    last, here, solver = 32, PlanSolver(PROGRAM, plan_time=60.0), ProcessSolver(alone)
    ask = parse_update(f"#step 1 : 50. _request({last},1). #endstep.")
    first = here.update(ask)
    assert solver.update(ask) == first
    assert first.horizon == last
    assert not solver.prefetch(FAILED)
    assert alone.standby_pid is None
    os.kill(alone.pid, signal.SIGSTOP)
    for step in range(2, last):
        result = solver.update(onward(step, step - 1))
        assert result == here.update(onward(step, step - 1))
        assert (result.step, result.answers) == (step, first.answers)
    kill(alone)
    failed = onward(last, "no")
    assert from_now_on(solver.update(failed)) == from_now_on(here.update(failed))
    assert here.horizon > first.horizon
    assert solver.log.key == here.log.key


def idling(pool):
    """Return a solver with a plan that idles for a cycle, the plan, and its first action."""
    solver = ProcessSolver(pool)
    assert solver.improve() is None
    soon = solver.update(ASK)
    assert (solver.log.plan, soon.shortest) == (Plan.from_result(soon), False)
    (action,) = (one for one in solver.log.plan.actions if cycle_of(one) == 1)
    worse = Plan(solver.log.plan.delayed().actions | {action}, solver.log.plan.horizon + 1)
    solver.restore(solver.log.adopt(worse))
    return solver, worse, action


@pytest.mark.slow
@pytest.mark.parametrize("event", ["stopped", "killed"])
def test_worker_improves_the_plan_in_force(event):
    """Also a worker started later; a stop does not wait for the improvement."""
    with pool_of(plan_time=0.0) as pool:
        solver, worse, action = idling(pool)
        if event == "killed":
            kill(pool)
        if event == "stopped":
            os.kill(pool.pid, signal.SIGSTOP)
        for _ in range(2):
            assert solver.improve(lambda: True) is None
        assert solver.log.plan == worse
        if event == "stopped":
            os.kill(pool.pid, signal.SIGCONT)
        while (result := solver.improve()) is not None:
            assert Plan.from_result(result) == solver.log.plan
        assert solver.log.plan.horizon == 5
        assert action in solver.log.plan.actions
        assert solver.update(parse_update(f"#step 2. :- not {action}. #endstep.")).horizon == 5


@pytest.mark.slow
def test_worker_answers_hypothetical_questions_like_a_solver():
    program = ReactiveProgram.from_text("#external e/1.\n#program cumulative(t).\n:- e(1), e(2), not e(3).\n")
    first, update = (parse_update(f"#step {text} #endstep.") for text in ("1 : 1.", '2 : 1. e(1). e(2). e("3").'))
    facts = frozenset(map(parse_atom, ["e(1)", "e(2)", 'e("3")']))
    with pool_of(program) as pool:
        here, solver = PlanSolver(program), ProcessSolver(pool)
        solver.update(first)
        here.update(first)
        log = solver.log
        for disabled in (frozenset(), frozenset([parse_atom("e(1)")])):
            found, expected = (one.inquire(update, facts, disabled) for one in (solver, here))
            assert (found.satisfiable, found.core) == (expected.satisfiable, expected.core)
        assert solver.inquire(update, facts, frozenset()).core == facts - {parse_atom('e("3")')}
        assert solver.log is log
