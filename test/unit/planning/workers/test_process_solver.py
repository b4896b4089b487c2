"""Process solvers: they answer as a solver in this process, and prefetch answers."""

import os
import signal
from dataclasses import replace

import pytest
from children import ended, kill, wait_until_prepared
from plain_walk import ONWARD, onward, program_text

from rosoclingo.oclingo import ReactiveProgram, SolverError, parse_atom, parse_update
from rosoclingo.planning.history import AdoptedPlan, Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers import process_solver
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver

PROGRAM = ReactiveProgram.from_text(ONWARD)
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


@pytest.mark.mostly_slow
@pytest.mark.parametrize("waits", [True, False])
def test_standby_that_prefetched_takes_over(here, pool, solver, waits):
    """Also if it is still searching; the other worker becomes the standby."""
    old, standby = pool.pid, pool.standby_pid
    assert solver.prefetch(FAILED)
    if waits:
        wait_until_prepared(pool)
    worked = pool.cpu_time
    assert solver.update(FAILED) == here.update(FAILED)
    assert (pool.pid, pool.standby_pid) == (standby, old)
    assert pool.cpu_time >= worked
    assert (solver.log.key, solver.log.plan) == (here.log.key, here.log.plan)
    assert solver.update(AGAIN) == here.update(AGAIN)


@pytest.mark.mostly_slow
@pytest.mark.parametrize("comes", ["as predicted", "earlier"])
def test_answer_after_predicted_updates_is_prefetched(here, pool, solver, comes):
    before, later = [onward(2, 1), onward(3, 2)], onward(4, "no")
    pids = pool.pid, pool.standby_pid
    assert not solver.prefetch(onward(3, 2), [FAILED]), "the failure is not predicted"
    assert solver.prefetch(later, before)
    if comes == "earlier":
        for update in (FAILED, AGAIN):
            assert solver.update(update) == here.update(update)
        assert pool.pid == pids[0]
        return
    wait_until_prepared(pool)
    for update in before:
        assert solver.update(update) == here.update(update)
        assert (pool.pid, pool.standby_pid) == pids
    assert solver.update(later) == here.update(later)
    assert pool.pid == pids[1]


def as_planned(plan, step):
    """Return the update after a cycle that succeeded."""
    done = sorted(one for one in plan.actions if cycle_of(one) == step - 1)
    items = "".join(f":- not {one}. _return({','.join(map(str, one.arguments))})." for one in done)
    return parse_update(f"#step {step} : 50. #closed {step - 1}. {items} #endstep.")


@pytest.mark.slow
def test_prefetched_plan_is_shortened_until_its_update(here):
    with pool_of(plan_time=0.0, standby=True) as pool:
        solver = ProcessSolver(pool)
        solver.update(ASK)
        before = as_planned(solver.log.plan, 2)
        later = parse_update(str(as_planned(solver.log.plan, 3)).replace("_return(go,1,2)", "_return(go,no,2)"))
        assert solver.prefetch(later, [before])
        wait_until_prepared(pool)
        found = [solver.update(update) for update in (before, later)]
        standby = pool.pid
        assert solver.log.plan == Plan.from_result(found[-1])
        solver.update(as_planned(solver.log.plan, 4))
        assert pool.pid == standby
    assert found[-1].horizon == [here.update(update).horizon for update in (before, later)][-1]


@pytest.mark.parametrize("value", ["1", "other"])
def test_prefetched_answer_is_unused_after_another_update(here, pool, solver, value):
    pid = pool.pid
    assert not here.has_prefetched(FAILED), "nothing is prefetched"
    solver.prefetch(FAILED)
    wait_until_prepared(pool)
    assert solver.has_prefetched(FAILED)
    assert not solver.has_prefetched(onward(2, value)), "another update was prefetched"
    assert solver.update(onward(2, value)) == here.update(onward(2, value))
    assert pool.pid == pid


def test_solver_waits_for_prefetched_answers_until_stopped(pool, solver):
    slow = onward(2, "slow")
    assert not solver.has_prefetched(slow, lambda: False), "nothing is prefetched"
    os.kill(pool.standby_pid, signal.SIGSTOP)
    try:
        solver.prefetch(slow)
        looks = iter([False, False, True])
        assert not solver.has_prefetched(slow, lambda: next(looks))
    finally:
        os.kill(pool.standby_pid, signal.SIGCONT)
    assert solver.has_prefetched(slow, lambda: False)


def test_only_updates_that_need_no_search_are_predicted(here, solver):
    for one in (here, solver):
        assert one.predicts(onward(2, 1))
        assert not one.predicts(FAILED)
        assert not one.predicts(onward(3, 1))


def test_standby_prefetches_the_latest_question(here, pool, solver):
    for number in range(5):
        solver.prefetch(onward(2, f"no{number}"))
    for _ in range(2):
        solver.prefetch(FAILED)
        wait_until_prepared(pool)
    standby = pool.standby_pid
    assert solver.update(FAILED) == here.update(FAILED)
    assert pool.pid == standby


@pytest.mark.parametrize("when", ["begun", "ready"])
def test_lost_standby_costs_only_its_answer(here, pool, solver, when):
    solver.prefetch(FAILED)
    if when == "ready":
        wait_until_prepared(pool)
    os.kill(pool.standby_pid, signal.SIGKILL)
    assert ended(pool.standby_pid)
    assert not solver.has_prefetched(FAILED)
    assert solver.prefetch(FAILED), "a new standby starts"
    assert solver.update(FAILED) == here.update(FAILED)


def test_standby_that_prefetches_replaces_a_lost_worker(here, pool, solver):
    """It drops its search, which does not affect the next answer."""
    solver.prefetch(FAILED)
    standby = pool.standby_pid
    kill(pool)
    assert solver.update(onward(2, "other")) == here.update(onward(2, "other"))
    assert pool.pid == standby


@pytest.mark.slow
@pytest.mark.parametrize("again", [True, False])
def test_improved_plan_causes_prefetching_once_more(here, again):
    """The search after a failure starts from the improved plan; an older prefetched answer stays valid."""
    with pool_of(plan_time=0.0, standby=True) as pool:
        solver = ProcessSolver(pool)
        best = here.log.plan
        solver.update(ASK)
        (go,) = (action for action in best.actions if cycle_of(action) == 1)
        idle = parse_atom("_action_lib(idle,1,2)")
        worse = Plan(frozenset({go, idle, *best.rest(2).delayed().actions}), best.horizon + 1)
        for plan in (worse, best):
            solver.restore(solver.log.adopt(plan))
            if again or plan is worse:
                assert solver.prefetch(FAILED)
                wait_until_prepared(pool)
        standby = pool.standby_pid
        result = solver.update(FAILED)
        assert pool.pid == standby
        assert solver.log.plan == Plan.from_result(result)
        assert not again or result.horizon == best.horizon + 1


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
@pytest.mark.parametrize("between", [signal.SIGCONT, signal.SIGKILL])
def test_predicted_update_does_not_wait_for_the_worker(alone, between):
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
    os.kill(alone.pid, between)
    if between == signal.SIGKILL:
        kill(alone)
    failed = onward(last, "no")
    assert from_now_on(solver.update(failed)) == from_now_on(here.update(failed))
    assert here.horizon > first.horizon
    assert solver.log.key == here.log.key


@pytest.mark.slow
def test_worker_appends_checkpoint_after_predicted_updates(alone, monkeypatch):
    """A stop does not wait for the checkpoint, and another worker can read it."""
    monkeypatch.setattr(process_solver, "LONG_PREDICTED", 3)
    here, solver = PlanSolver(PROGRAM, plan_time=60.0), ProcessSolver(alone)

    def length():
        return sum(not isinstance(one, AdoptedPlan) for one in solver.log.entries)

    ask = parse_update("#step 1 : 50. _request(9,1). #endstep.")
    assert solver.update(ask) == here.update(ask)
    for step in range(2, 9):
        assert solver.update(onward(step, step - 1)) == here.update(onward(step, step - 1))
        if step == 5:
            log = solver.log
            os.kill(alone.pid, signal.SIGSTOP)
            solver.compact(lambda: True)
            assert solver.log is log
            os.kill(alone.pid, signal.SIGCONT)
        if step in (3, 6):
            solver.compact(lambda: False)
            assert length() == (1 if step == 6 else 3)
        if step == 7:
            kill(alone)
    assert length() == 3, "the checkpoint and the later updates"
    found, expected = solver.update(onward(9, "no")), here.update(onward(9, "no"))
    assert (found.outcome, found.horizon) == (expected.outcome, expected.horizon)


PLAIN = ReactiveProgram.from_text(program_text())
ASK_PLAIN = parse_update("#step 1. _request(3,1). #endstep.")


def idling(pool):
    """Return a solver with a plan that idles for a cycle, the plan, and its first action."""
    solver = ProcessSolver(pool)
    assert solver.improve() is None
    soon = solver.update(ASK_PLAIN)
    assert (solver.log.plan, soon.shortest) == (Plan.from_result(soon), False)
    (action,) = (one for one in solver.log.plan.actions if cycle_of(one) == 1)
    worse = Plan(solver.log.plan.delayed().actions | {action}, solver.log.plan.horizon + 1)
    solver.restore(solver.log.adopt(worse))
    return solver, worse, action


@pytest.mark.mostly_slow
@pytest.mark.parametrize("event", ["", "stopped", "killed"])
def test_worker_improves_the_plan_in_force(event):
    """Also a worker started later; a stop does not wait for the improvement."""
    with pool_of(PLAIN, plan_time=0.0) as pool:
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
        assert solver.log.plan.horizon == 3
        assert action in solver.log.plan.actions
        assert solver.update(parse_update(f"#step 2. :- not {action}. #endstep.")).horizon == 3


@pytest.mark.slow
def test_new_worker_begins_with_the_plan_in_force():
    with pool_of(PLAIN, plan_time=0.0) as pool:
        solver, worse, action = idling(pool)
        kill(pool)
        again = solver.update(parse_update(f"#step 2. :- not {action}. fail(1). #endstep."))
        assert Plan.from_result(again).rest(2).actions == worse.rest(2).actions


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
