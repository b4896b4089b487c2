"""Worker pools: the same answers even if processes are killed or replaced."""

import os
import random
import signal
import subprocess
import sys
from contextlib import suppress

import pytest
from children import ended, kill
from plain_walk import LINE
from workloads import sized

from rosoclingo.oclingo import (
    DroppedError,
    ReactiveProgram,
    SolveOutcome,
    SolverError,
    parse_atom,
    parse_update,
)
from rosoclingo.planning.history import Checkpoint
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.planning.workers.worker_main import SEARCHES

ECHO = "#cumulative t.\n#external e(t).\nc(t) :- e(t).\n"
ENDLESS = ECHO + "#volatile t.\n:- not c(t).\n"
#: Grounding step 2 does not terminate.
EXPLODING = "#cumulative t.\n#external e(t).\nn(0,t) :- t > 1.\nn(X+1,t) :- n(X,t), X < 2000000000.\n"

PLANS = {"shortest": True}


def pool_of(text, **options):
    return WorkerPool(ReactiveProgram.from_text(text), **options)


def fed(solver, text, stopped=None):
    """Send an update and return the result."""
    return solver.update(parse_update(f"#step {text} #endstep."), stopped)


def answers(result):
    return [sorted(map(str, answer)) for answer in result.answers]


def after_work(pool, seconds=0.1):
    """Return a stop callback that returns true once the worker has used that much processor time."""
    before = pool.cpu_time
    return lambda: pool.cpu_time > before + seconds


# ---- Lifetime of workers ---------------------------------------------------------------------------------------------


def test_closed_pool_refuses_all_questions():
    pool = pool_of(ECHO)
    pool.close()
    with pytest.raises(SolverError, match="has been closed"):
        ProcessSolver(pool).solve()


@pytest.mark.slow
def test_update_that_crashes_two_workers_is_dropped():
    with pool_of(ENDLESS) as pool:
        solver = ProcessSolver(pool)
        fed(solver, "1 : 0. e(1).")

        def stopped():
            kill(pool)
            return False

        with pytest.raises(DroppedError, match="ended by signal SIGKILL; the request was discarded"):
            fed(solver, "2.", stopped)
        assert answers(fed(solver, "1 : 0.")) == [["c(1)", "e(1)"]]


@pytest.mark.slow
@pytest.mark.parametrize("fork", [False, True])
def test_worker_ends_with_parent_even_while_grounding(fork):
    code = (
        "import sys\nfrom rosoclingo.oclingo import *\n"
        "from rosoclingo.planning.workers.pool import WorkerPool\n"
        f"process = WorkerPool(ReactiveProgram.from_text({EXPLODING!r}), fork={fork})\nprocess.start()\n"
        "looks = []\n"
        "def stopped():\n    looks.append(0)\n    len(looks) == 9 and print(process.pid, flush=True)\n"
        "from rosoclingo.planning.workers.process_solver import ProcessSolver\n"
        "ProcessSolver(process).update(parse_update('#step 2. #endstep.'), stopped)\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as parent:
        child = int(parent.stdout.readline())
        parent.kill()
    assert ended(child), "the child outlived its parent"


@pytest.mark.slow
def test_standby_takes_the_place_of_killed_worker():
    with pool_of(EXPLODING, patience=0.1, standby=True) as pool:
        solver = ProcessSolver(pool)
        pool.start()
        assert pool.standby_pid is None, "workers start in sequence"
        fed(solver, "1. e(1).")
        for _ in range(2):
            fed(solver, "1.")
            lost, standby, worked, elapsed = pool.pid, pool.standby_pid, pool.cpu_time, pool.stopwatch()
            with pytest.raises(DroppedError, match="ignored a stop while grounding"):
                fed(solver, "2. e(2).", after_work(pool))
            assert ended(lost)
            assert (pool.pid, pool.standby_pid) == (standby, None)
            assert pool.cpu_time > worked + 0.1, "the time of killed workers counts"
            assert elapsed() > 0.1
            assert (solver.step, solver.horizon) == (1, 1)
        assert answers(fed(solver, "1.")) == [["e(1)"]]
        standby = pool.standby_pid
    assert ended(standby)


MANY = "#show.\n#external big/1.\n#cumulative t.\nn(B,X) :- big(B), X = 1..100000, t = 1.\n"


@pytest.mark.slow
def test_worker_that_has_grown_is_replaced_after_many_searches():
    with pool_of(MANY, **PLANS, growth=2**22) as pool:
        solver, pids = ProcessSolver(pool), []
        log = solver.log
        for number in range(SEARCHES + 2):
            solver.restore(log)
            fed(solver, f"1. big({number})." if number % 20 == 19 else "1.")
            pids.append(pool.pid)
    assert len(set(pids[: SEARCHES - 1])) == 1, "one large grounding does not end a worker"
    assert len(set(pids)) == 2, "the atoms of the large groundings are never freed"


@pytest.mark.slow
def test_worker_that_has_not_grown_is_kept():
    with pool_of(MANY, **PLANS) as pool:
        solver, pids = ProcessSolver(pool), set()
        log = solver.log
        for _ in range(SEARCHES + 2):
            solver.restore(log)
            fed(solver, "1.")
            pids.add(pool.pid)
    assert len(pids) == 1


# ---- Stops -----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_stop_ends_search_and_keeps_its_update():
    with pool_of(ENDLESS, patience=600.0, **PLANS, horizon_limit=100_000, log_limit=0) as pool:
        solver = ProcessSolver(pool)
        fed(solver, "1 : 0. e(1).")
        pid = pool.pid
        result = fed(solver, "2.", after_work(pool))
        assert (result.outcome, solver.step) == (SolveOutcome.INTERRUPTED, 2)
        assert pool.pid == pid, "the worker obeyed the stop"
        assert result.horizon == solver.horizon > 2
        checkpoint = solver.log.entries[0]
        assert isinstance(checkpoint, Checkpoint)
        assert (checkpoint.message["step"], checkpoint.message["horizon"]) == (2, result.horizon)
        kill(pool)
        late = fed(solver, f"{result.horizon} : 0. e({result.horizon}).")
        assert late.outcome is SolveOutcome.SATISFIABLE
        reader = PlanSolver(ReactiveProgram.from_text(ENDLESS))  # answers of workers omit atoms of past cycles
        reader.restore(solver.log)
        assert parse_atom("e(1)") in reader.solve().answers[0]


# ---- Long streams ----------------------------------------------------------------------------------------------------


def update_of(cycle, done):
    """Return the update of one cycle after the actions ``done``, sometimes with a request."""
    past = f"#closed {cycle - 1}. #over {max(0, cycle - 10)}. " if cycle > 1 else ""
    request = f"_request({cycle % 5 - 2},{cycle + 1})." if cycle % 7 == 0 else ""
    return f"{cycle}. {past}" + "".join(f":- not {atom}. " for atom in done) + request


@pytest.mark.slow
def test_pool_stream_survives_many_kills():
    """Kills hit the active worker, the standby or both, between updates and during searches."""
    draw, twin = random.Random(1), PlanSolver(ReactiveProgram.from_text(LINE), log_limit=2)
    with pool_of(LINE, **PLANS, log_limit=2, standby=True) as pool:
        solver, kills, cycle, done, now = ProcessSolver(pool), [], 0, [], []

        def kill_some():
            for pid in draw.choice([[pool.pid], [pool.standby_pid], [pool.pid, pool.standby_pid]]):
                with suppress(TypeError, ProcessLookupError):  # there is no such process
                    os.kill(pid, signal.SIGKILL)
                    assert ended(pid)
                    kills.append(pid)

        while len(kills) < sized(5, 20) or len(done) < 3:  # kills happen only while the worker searches
            cycle += 1
            if draw.random() < 0.5:
                kill_some()
            twin.restore(solver.log)
            text, first_look = update_of(cycle, now), [draw.random() < 0.7]
            result = fed(solver, text, lambda looks=first_look: bool(looks and looks.pop() and kill_some()))
            assert result.horizon == fed(twin, text).horizon
            actions = [atom for atom in result.answers[0] if atom.name == "_action_lib"]
            past = {one for one in actions if one.arguments[2].number < cycle}
            assert {one for one in done if one.arguments[2].number >= cycle - 10} <= past <= set(done)
            now = [one for one in actions if one.arguments[2].number == cycle]
            done += now
        assert solver.log.length <= 8
