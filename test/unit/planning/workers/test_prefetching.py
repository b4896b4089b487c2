"""Answers that the child which is kept ready has before their updates come."""

import os
import signal

import pytest
from children import ended, kill, wait_until_prepared

from rosoclingo.oclingo import ReactiveProgram, SolverError, parse_atom, parse_update
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers import child as child_module
from rosoclingo.planning.workers import worker
from rosoclingo.planning.workers.pool import WorkerPool

OPTIONS = {"plan_time": 60.0}

#: A robot goes from place to place; where it is told of a failure, clingo has to ground anew what might depend on it.
WALK = """
#program base. at(0,0). #show _action_lib/3.
#program cumulative(t).
#external _request/2. #external _return/3. #external _failed/3.
{ _action_lib(go,X+1,t); _action_lib(idle,X,t) } 1 :- at(X,t-1), wanted(Y,t), X < Y.
at(X,t) :- _action_lib(go,X,t), not _failed(go,_,t).
at(X,t) :- at(X,t-1), not moved(t).
moved(t) :- _action_lib(go,X,t), not _failed(go,_,t).
wanted(X,t) :- _request(X,t).
wanted(X,t) :- wanted(X,t-1).
#program volatile(t).
:- wanted(X,t), not at(X,t).
"""

ASK = parse_update("#step 1 : 50. _request(5,1). #endstep.")


def after_first(value):
    """The update that tells how the first action ended."""
    return parse_update(f"#step 2 : 50. #closed 1. :- not _action_lib(go,1,1). _return(go,{value},1). #endstep.")


@pytest.fixture
def here():
    """A solver in this process."""
    solver = PlanSolver(ReactiveProgram.from_text(WALK), **OPTIONS)
    solver.update(ASK)
    return solver


@pytest.fixture(scope="module")
def process():
    """A process for all tests, as its children take long to start."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker, "PAUSE", 0.0)
        with WorkerPool(ReactiveProgram.from_text(WALK), spare=True, shortest=True, **OPTIONS) as one:
            yield one


@pytest.fixture
def solver(process):
    """A solver in ``process`` that has been asked; the child that is kept ready is at nothing else."""
    one = process.solver()
    one.update(ASK)
    wait_until_prepared(process)
    return one


@pytest.mark.mostly_slow
@pytest.mark.parametrize("waits", [True, False])
def test_the_answer_that_was_prepared_is_the_one_that_is_searched_for(here, process, solver, waits):
    """The child that has it goes on; whether it is there or under way."""
    old, spare = process.pid, process.spare_pid
    solver.prepare(after_first("no"))
    if waits:
        wait_until_prepared(process)
    worked = process.worked
    assert solver.update(after_first("no")) == here.update(after_first("no"))
    assert (process.pid, process.spare_pid) == (spare, None)
    assert ended(old)
    assert process.worked >= worked
    assert solver.log.key == here.log.key
    assert solver.log.plan == here.log.plan
    done = "#step 3 : 50. #closed 2. :- not _action_lib(go,1,2). _return(go,no,2). #endstep."
    assert solver.update(parse_update(done)) == here.update(parse_update(done))
    assert process.spare_pid is not None, "another one is kept ready"


def step(number, value):
    """The update that tells how the action before went."""
    done = f"#closed {number - 1}. :- not _action_lib(go,{number - 1},{number - 1})."
    return parse_update(f"#step {number} : 50. {done} _return(go,{value},{number - 1}). #endstep.")


def test_the_answer_to_a_later_update_is_prepared(here, process, solver):
    before, later = [step(2, 1), step(3, 2)], step(4, "no")
    pids = process.pid, process.spare_pid
    assert solver.prepare(later, before)
    wait_until_prepared(process)
    for update in before:
        assert solver.update(update) == here.update(update)
        assert (process.pid, process.spare_pid) == pids
    assert solver.update(later) == here.update(later)
    assert process.pid == pids[1]


def test_it_is_of_no_use_where_another_one_comes_before(here, process, solver):
    pid = process.pid
    assert solver.prepare(step(3, "no"), [step(2, 1)])
    assert solver.update(step(2, "no")) == here.update(step(2, "no"))
    again = parse_update("#step 3 : 50. #closed 2. :- not _action_lib(go,1,2). _return(go,no,2). #endstep.")
    assert solver.update(again) == here.update(again)
    assert process.pid == pid


def as_planned(plan, number):
    """The update that tells that all went as planned."""
    done = sorted(one for one in plan.actions if cycle_of(one) == number - 1)
    told = "".join(f":- not {one}. _return({','.join(map(str, one.arguments))})." for one in done)
    return parse_update(f"#step {number} : 50. #closed {number - 1}. {told} #endstep.")


@pytest.mark.slow
def test_a_plan_is_shortened_while_there_is_time(monkeypatch):
    """That is, until its update comes, or nothing is left to try."""
    monkeypatch.setattr(worker, "PAUSE", 0.0)
    program = ReactiveProgram.from_text(WALK)
    with WorkerPool(program, spare=True, shortest=True, **{**OPTIONS, "plan_time": 0.0}) as one:
        solver = one.solver()
        solver.update(ASK)
        before = as_planned(solver.log.plan, 2)
        later = parse_update(str(as_planned(solver.log.plan, 3)).replace("_return(go,1,2)", "_return(go,no,2)"))
        assert solver.prepare(later, [before])
        wait_until_prepared(one)
        found = [solver.update(update) for update in (before, later)]
        spare = one.pid
        assert solver.log.plan == Plan.in_result(found[-1])
        solver.update(as_planned(solver.log.plan, 4))
        assert one.pid == spare
    other = PlanSolver(program, **{**OPTIONS, "plan_time": 60.0})
    assert found[-1].horizon == [other.update(update).horizon for update in (ASK, before, later)][-1]


def test_whether_an_answer_is_there_is_known_without_waiting_for_it(here, process, solver):
    update = after_first("other")
    assert not solver.has_prepared(update)
    assert not here.has_prepared(update), "nobody prepares anything"
    solver.prepare(update)
    wait_until_prepared(process)
    assert solver.has_prepared(update)
    assert not solver.has_prepared(after_first("1")), "that is another one"
    os.kill(process.spare_pid, signal.SIGKILL)
    assert ended(process.spare_pid)
    assert not solver.has_prepared(update)
    assert solver.update(update) == here.update(update)


def test_nothing_is_prepared_behind_what_takes_a_search(solver):
    assert not solver.prepare(step(3, 2), [step(2, "no")])


@pytest.mark.parametrize("value", ["1", "other"])
def test_what_was_prepared_is_of_no_use_where_something_else_comes(here, process, solver, value):
    pid = process.pid
    solver.prepare(after_first("no"))
    assert solver.update(after_first(value)) == here.update(after_first(value))
    assert process.pid == pid


def test_the_latest_is_what_is_prepared(here, process, solver):
    """However many there were that nothing came of."""
    for number in range(5):
        solver.prepare(after_first(f"no{number}"))
    wait_until_prepared(process)
    for _ in range(2):
        solver.prepare(after_first("no"))
    wait_until_prepared(process)
    spare = process.spare_pid
    assert solver.update(after_first("no")) == here.update(after_first("no"))
    assert process.pid == spare


@pytest.mark.parametrize("when", ["begun", "ready"])
def test_the_child_that_prepares_may_be_lost(here, process, solver, when):
    solver.prepare(after_first("no"))
    if when == "ready":
        wait_until_prepared(process)
    os.kill(process.spare_pid, signal.SIGKILL)
    assert ended(process.spare_pid)
    assert solver.update(after_first("no")) == here.update(after_first("no"))


def test_the_child_that_prepares_takes_the_place_of_one_that_is_lost(here, process, solver):
    """What it was at is left; nothing of that gets among what it is asked next."""
    solver.prepare(after_first("no"))
    spare = process.spare_pid
    kill(process)
    assert solver.update(after_first("other")) == here.update(after_first("other"))
    assert process.pid == spare


@pytest.mark.slow
def test_it_is_replaced_once_it_has_grown(monkeypatch):
    monkeypatch.setattr(child_module, "GROWTH", 0)
    monkeypatch.setattr(worker, "PAUSE", 0.0)
    sizes = iter([10, 100, 10])
    monkeypatch.setattr(child_module.WorkerProcess, "memory", property(lambda self: next(sizes)))
    pids = []
    with WorkerPool(ReactiveProgram.from_text(WALK), spare=True, shortest=True, **OPTIONS) as one:
        solver = one.solver()
        solver.update(ASK)
        for number in range(3):
            solver.prepare(after_first(f"no{number}"))
            pids.append(one.spare_pid)
            wait_until_prepared(one)
    assert pids[0] != pids[1] == pids[2]


@pytest.mark.slow
def test_a_plan_that_has_become_better_is_prepared_for(here):
    """The robot goes on from it where the failure leaves it one."""
    with WorkerPool(ReactiveProgram.from_text(WALK), spare=True, shortest=True, **{**OPTIONS, "plan_time": 0.0}) as one:
        solver = one.solver()
        best = here.log.plan
        solver.update(ASK)
        (go,) = (action for action in best.actions if cycle_of(action) == 1)
        idle = parse_atom("_action_lib(idle,1,2)")
        solver.restore(solver.log.adopt(Plan(frozenset({go, idle, *best.since(2).later().actions}), best.horizon + 1)))
        solver.prepare(after_first("no"))
        wait_until_prepared(one)
        solver.restore(solver.log.adopt(best))
        solver.prepare(after_first("no"))
        wait_until_prepared(one)
        assert solver.update(after_first("no")).horizon == best.horizon + 1


@pytest.mark.slow
def test_an_update_that_is_refused_is_refused_though_it_was_prepared():
    limited = {**OPTIONS, "horizon_limit": 3}
    with WorkerPool(ReactiveProgram.from_text(WALK), spare=True, shortest=True, **limited) as one:
        solver = one.solver()
        solver.update(parse_update("#step 1 : 50. _request(1,1). #endstep."))
        solver.prepare(parse_update("#step 9 : 50. #endstep."))
        wait_until_prepared(one)
        with pytest.raises(SolverError, match="beyond the horizon limit"):
            solver.update(parse_update("#step 9 : 50. #endstep."))
        assert solver.update(after_first("1")).step == 2


def test_nothing_is_prepared_where_none_is_kept_ready():
    with WorkerPool(ReactiveProgram.from_text(WALK), shortest=True, **OPTIONS) as one:
        solver = one.solver()
        solver.update(ASK)
        solver.prepare(after_first("no"))
        assert one.spare_pid is None
        solver.update(after_first("no"))
