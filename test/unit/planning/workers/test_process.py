"""Worker processes, forked and spawned: answers, exit codes and open files."""

import os
import select

from children import ended, kill

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.planning.workers import worker_main
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process import WorkerProcess
from rosoclingo.planning.workers.process_solver import ProcessSolver

PROGRAM = ReactiveProgram.from_text("#cumulative t.\n#external e(t).\nc(t) :- e(t).\n")


def test_forked_workers_answer_and_are_replaced():
    with WorkerPool(PROGRAM, fork=True) as pool:
        solver = ProcessSolver(pool)
        solver.update(parse_update("#step 1. e(1). #endstep."))
        lost = pool.pid
        kill(pool)
        result = solver.update(parse_update("#step 2. e(2). #endstep."))
        assert pool.pid != lost
    assert sorted(map(str, result.answers[0])) == ["c(1)", "c(2)", "e(1)", "e(2)"]


def test_fork_that_fails_ends_with_the_error(monkeypatch, capfd):
    def fail(*_arguments):
        raise ValueError("a fault of its own")

    monkeypatch.setattr(worker_main, "work", fail)
    process = WorkerProcess(PROGRAM, {}, fork=True)
    assert ended(process.pid)
    assert process.kill() == 1
    assert "ValueError: a fault of its own" in capfd.readouterr().err


def test_forked_worker_has_no_other_open_files():
    """Otherwise connections closed by the parent would stay open."""
    reader, writer = os.pipe()
    with WorkerPool(PROGRAM, fork=True) as pool:
        pool.start()
        os.close(writer)
        assert select.select([reader], [], [], 0)[0], "the writer is still open in the worker"
    os.close(reader)
