"""Worker processes: nobody waits for one that hangs."""

import os
import signal

import pytest
from children import ended

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.workers.wire import program_to_message
from rosoclingo.planning.workers.worker import Worker, WorkerLostError

PATIENCE = (300.0, 300.0)


def load(text=""):
    """A command to load a program."""
    program = program_to_message(ReactiveProgram.from_text(f"#program base. a. {text}"))
    return {"do": "load", "program": program, "options": {}}


@pytest.fixture
def worker():
    one = Worker(load(), PATIENCE)
    yield one
    one.kill()


@pytest.mark.slow
def test_worker_that_hangs_is_not_waited_for(worker):
    assert worker.finish(None) == {}
    os.kill(worker.pid, signal.SIGSTOP)
    for _ in range(3):
        worker.begin(load(f'b("{"x" * 2**20}").'))
    assert worker.is_busy()
    os.kill(worker.pid, signal.SIGCONT)
    assert worker.finish(None) == {}
    assert not worker.is_busy()


def test_worker_that_hangs_can_be_killed(worker):
    assert worker.memory > 0
    os.kill(worker.pid, signal.SIGSTOP)
    worker.begin(load(f'b("{"x" * 2**20}").'))
    worker.kill()
    assert (worker.memory, worker.is_busy()) == (0, False)


def test_worker_that_ended_is_reported_as_lost(worker):
    os.kill(worker.pid, signal.SIGKILL)
    assert ended(worker.pid)
    worker.begin(load())
    with pytest.raises(WorkerLostError, match="ended by signal SIGKILL"):
        worker.finish(None)
