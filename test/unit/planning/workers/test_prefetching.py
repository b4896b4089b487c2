"""Prefetching: the standby has an answer before its update comes."""

import os
import signal

import pytest
from children import ended, kill, wait_until_prepared
from plain_walk import ONWARD, onward

from rosoclingo.oclingo import ReactiveProgram, SolverError, parse_atom, parse_update
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers import worker
from rosoclingo.planning.workers.pool import WorkerPool

PROGRAM = ReactiveProgram.from_text(ONWARD)
OPTIONS = {"plan_time": 60.0}
ASK = parse_update("#step 1 : 50. _request(5,1). #endstep.")


#: The first action failed and was done again.
AGAIN = onward(3, "no", place=1)


def pool_of(**options):
    return WorkerPool(PROGRAM, standby=True, shortest=True, **{**OPTIONS, **options})


@pytest.fixture
def here():
    """A solver in this process."""
    solver = PlanSolver(PROGRAM, **OPTIONS)
    solver.update(ASK)
    return solver


@pytest.fixture(scope="module")
def pool():
    """A pool for all tests, as its workers take long to start."""
    with pool_of() as one:
        yield one


@pytest.fixture
def solver(pool):
    """A solver that has been asked; the standby is idle."""
    one = pool.solver()
    one.update(ASK)
    wait_until_prepared(pool)
    return one


@pytest.mark.mostly_slow
@pytest.mark.parametrize("waits", [True, False])
def test_standby_that_prefetched_takes_over(here, pool, solver, waits):
    """Also while it still searches."""
    old, spare = pool.pid, pool.standby_pid
    assert solver.prepare(onward(2, "no"))
    if waits:
        wait_until_prepared(pool)
    worked = pool.cpu_time
    assert solver.update(onward(2, "no")) == here.update(onward(2, "no"))
    assert (pool.pid, pool.standby_pid) == (spare, None)
    assert ended(old)
    assert pool.cpu_time >= worked
    assert solver.log.key == here.log.key
    assert solver.log.plan == here.log.plan
    assert solver.update(AGAIN) == here.update(AGAIN)
    assert pool.standby_pid is not None, "there is another standby"


@pytest.mark.mostly_slow
@pytest.mark.parametrize("comes", ["as predicted", "earlier"])
def test_answer_is_prefetched_behind_predicted_updates(here, pool, solver, comes):
    before, later = [onward(2, 1), onward(3, 2)], onward(4, "no")
    pids = pool.pid, pool.standby_pid
    assert solver.prepare(later, before)
    if comes == "earlier":
        for update in (onward(2, "no"), AGAIN):
            assert solver.update(update) == here.update(update)
        assert pool.pid == pids[0]
        return
    wait_until_prepared(pool)
    for update in before:
        assert solver.update(update) == here.update(update)
        assert (pool.pid, pool.standby_pid) == pids
    assert solver.update(later) == here.update(later)
    assert pool.pid == pids[1]


def test_nothing_is_prefetched_behind_an_unpredicted_update(solver):
    assert not solver.prefetch(onward(3, 2), [onward(2, "no")])


def as_planned(plan, number):
    """The update after a cycle that went as planned."""
    done = sorted(one for one in plan.actions if cycle_of(one) == number - 1)
    told = "".join(f":- not {one}. _return({','.join(map(str, one.arguments))})." for one in done)
    return parse_update(f"#step {number} : 50. #closed {number - 1}. {told} #endstep.")


@pytest.mark.slow
def test_prefetched_plan_is_shortened_until_its_update_comes():
    with pool_of(plan_time=0.0) as pool:
        solver = pool.solver()
        solver.update(ASK)
        before = as_planned(solver.log.plan, 2)
        later = parse_update(str(as_planned(solver.log.plan, 3)).replace("_return(go,1,2)", "_return(go,no,2)"))
        assert solver.prefetch(later, [before])
        wait_until_prepared(pool)
        found = [solver.update(update) for update in (before, later)]
        spare = pool.pid
        assert solver.log.plan == Plan.from_result(found[-1])
        solver.update(as_planned(solver.log.plan, 4))
        assert pool.pid == spare
    other = PlanSolver(PROGRAM, **OPTIONS)
    assert found[-1].horizon == [other.update(update).horizon for update in (ASK, before, later)][-1]


def test_prefetched_answer_is_announced_without_waiting(here, pool, solver):
    update = onward(2, "other")
    assert not solver.has_prefetched(update)
    assert not here.has_prefetched(update), "nobody prefetches"
    solver.prefetch(update)
    wait_until_prepared(pool)
    assert solver.has_prefetched(update)
    assert not solver.has_prefetched(onward(2, 1)), "that is another one"


@pytest.mark.parametrize("value", ["1", "other"])
def test_prefetched_answer_is_unused_after_another_update(here, pool, solver, value):
    pid = pool.pid
    solver.prefetch(onward(2, "no"))
    assert solver.update(onward(2, value)) == here.update(onward(2, value))
    assert pool.pid == pid


def test_standby_prefetches_the_latest_question(here, pool, solver):
    for number in range(5):
        solver.prefetch(onward(2, f"no{number}"))
    for _ in range(2):
        solver.prefetch(onward(2, "no"))
        wait_until_prepared(pool)
    spare = pool.standby_pid
    assert solver.update(onward(2, "no")) == here.update(onward(2, "no"))
    assert pool.pid == spare


@pytest.mark.parametrize("when", ["begun", "ready"])
def test_lost_standby_costs_only_its_answer(here, pool, solver, when):
    solver.prefetch(onward(2, "no"))
    if when == "ready":
        wait_until_prepared(pool)
    os.kill(pool.standby_pid, signal.SIGKILL)
    assert ended(pool.standby_pid)
    assert not solver.has_prepared(onward(2, "no"))
    assert solver.prepare(onward(2, "no")), "another one begins"
    assert solver.update(onward(2, "no")) == here.update(onward(2, "no"))


def test_standby_that_prefetches_replaces_a_lost_worker(here, pool, solver):
    """It abandons its search, of which nothing gets into the next answer."""
    solver.prepare(onward(2, "no"))
    spare = pool.standby_pid
    kill(pool)
    assert solver.update(onward(2, "other")) == here.update(onward(2, "other"))
    assert pool.pid == spare


@pytest.mark.slow
def test_grown_standby_is_replaced(monkeypatch):
    monkeypatch.setattr(worker, "GROWTH", 0)
    sizes = iter([10, 10, 100, 10])
    monkeypatch.setattr(worker.Worker, "memory", property(lambda self: next(sizes)))
    pids = []
    with pool_of() as pool:
        solver = pool.solver()
        solver.update(ASK)
        wait_until_prepared(pool)
        for number in range(2):
            solver.prepare(onward(2, f"no{number}"))
            pids.append(pool.standby_pid)
            wait_until_prepared(pool)
    assert pids[0] != pids[1]


@pytest.mark.slow
@pytest.mark.parametrize("again", [True, False])
def test_improved_plan_is_prefetched_for_again(here, again):
    """The search for the update after a failure begins with it; an answer from before is one, too."""
    with pool_of(plan_time=0.0) as pool:
        solver = pool.solver()
        best = here.log.plan
        solver.update(ASK)
        (go,) = (action for action in best.actions if cycle_of(action) == 1)
        idle = parse_atom("_action_lib(idle,1,2)")
        worse = Plan(frozenset({go, idle, *best.rest(2).delayed().actions}), best.horizon + 1)
        for plan in (worse, best):
            solver.restore(solver.log.adopt(plan))
            if again or plan is worse:
                assert solver.prefetch(onward(2, "no"))
                wait_until_prepared(pool)
        spare = pool.standby_pid
        result = solver.update(onward(2, "no"))
        assert pool.pid == spare
        assert solver.log.plan == Plan.from_result(result)
        assert not again or result.horizon == best.horizon + 1


@pytest.mark.slow
def test_refused_update_is_refused_though_prefetched():
    with pool_of(horizon_limit=3) as pool:
        solver = pool.solver()
        solver.update(parse_update("#step 1 : 50. _request(1,1). #endstep."))
        solver.prefetch(parse_update("#step 9 : 50. #endstep."))
        wait_until_prepared(pool)
        with pytest.raises(SolverError, match="beyond the horizon limit"):
            solver.update(parse_update("#step 9 : 50. #endstep."))
        assert solver.update(onward(2, "1")).step == 2


def test_pool_without_standby_prefetches_nothing():
    with WorkerPool(PROGRAM, shortest=True, **OPTIONS) as pool:
        solver = pool.solver()
        solver.update(ASK)
        assert not solver.prepare(onward(2, "no"))
        assert pool.standby_pid is None
        solver.update(onward(2, "no"))
