"""Solver workers: nothing waits for a worker that hangs."""

import os
import signal

import pytest

from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.question import never
from rosoclingo.planning.workers.worker import SolverWorker, WorkerRequest

PATIENCE = 300.0


def load(text=""):
    """Return a request to load a program."""
    return WorkerRequest("load", ([Source("a.lp", f"#program base. a. {text}")], {}, {}))


@pytest.fixture
def worker():
    one = SolverWorker(load(), PATIENCE)
    yield one
    one.kill()


@pytest.mark.slow
def test_pool_does_not_wait_for_hanging_workers(worker):
    worker.wait_until_ready(never)
    os.kill(worker.pid, signal.SIGSTOP)
    for _ in range(3):
        worker.begin(load(f'b("{"x" * 2**20}").'))
    assert worker.is_busy()
    os.kill(worker.pid, signal.SIGCONT)
    assert worker.ask(load(), never).value is None
    assert not worker.is_busy()


def test_hanging_worker_can_be_killed(worker):
    assert worker.memory > 0
    os.kill(worker.pid, signal.SIGSTOP)
    worker.begin(load(f'b("{"x" * 2**20}").'))
    worker.kill()
    assert (worker.memory, worker.is_busy()) == (0, False)
