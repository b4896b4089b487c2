"""The pipe to a child: what it is told is not waited for."""

import os
import signal

import pytest
from children import kill

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.remote.child import WorkerLostError, WorkerProcess
from rosoclingo.oclingo.remote.wire import program_to_message

PATIENCE = (300.0, 300.0)


@pytest.fixture
def child():
    one = WorkerProcess()
    yield one
    one.kill()


def load(text=""):
    """A command to load a program."""
    program = program_to_message(ReactiveProgram.from_text(f"#program base. a. {text}"))
    return {"do": "load", "program": program, "options": {}}


def test_a_child_that_does_not_read_is_not_waited_for(child):
    os.kill(child.pid, signal.SIGSTOP)
    for _ in range(3):
        child.send(load(f'b("{"x" * 2**20}").'))
    assert child.receive(0.0) is None
    os.kill(child.pid, signal.SIGCONT)
    replies = [child.reply(None, PATIENCE) for _ in range(3)]
    assert replies == [{}, {}, {}]


def test_a_child_that_does_not_read_can_be_ended(child):
    os.kill(child.pid, signal.SIGSTOP)
    child.send(load(f'b("{"x" * 2**20}").'))
    child.kill()
    with pytest.raises(WorkerLostError, match="ended by signal SIGKILL"):
        child.send(load())


def test_what_is_sent_to_a_child_that_has_ended_is_lost(child):
    kill(child)
    with pytest.raises(WorkerLostError, match="ended by signal SIGKILL"):
        child.send(load())
