"""Solver workers: nothing waits for a worker that hangs."""

import os
import signal

import pytest

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.planning.question import never
from rosoclingo.planning.workers.worker import SolverWorker, WorkerRequest

PING = WorkerRequest("ping")
LONG = WorkerRequest("search", (parse_update(f'#step 1. b("{"x" * 2**21}"). #endstep.'), False))


@pytest.fixture
def worker():
    one = SolverWorker(ReactiveProgram.from_text("a."), {}, patience=300.0, fork=False)
    yield one
    one.kill()


@pytest.mark.slow
def test_parent_does_not_wait_for_hanging_worker(worker):
    worker.ask(PING, never)
    os.kill(worker.pid, signal.SIGSTOP)
    for request in (PING, LONG, LONG):
        worker.begin(request)
    assert worker.is_busy()
    os.kill(worker.pid, signal.SIGCONT)
    assert len(worker.ask(LONG, never).value.answers) == 1
    assert not worker.is_busy()
