"""The pipe to a child: what it is told is not waited for."""

import os
import signal
import threading

import pytest
from children import kill

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.remote.child import Reader, WorkerLostError, WorkerProcess
from rosoclingo.oclingo.remote.wire import encode, program_to_message

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


def test_what_a_child_tells_is_read_whether_or_not_somebody_asks():
    reading, writing = os.pipe()
    reader, message = Reader(os.fdopen(reading, "rb", buffering=0)), {"text": "x" * 2**20}

    def tell():
        with os.fdopen(writing, "wb") as pipe:
            pipe.write(encode(message) * 3)

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    teller.join(300.0)
    assert not teller.is_alive()
    assert [reader.next(300.0) for _ in range(3)] == [message] * 3
    for _ in range(2):
        with pytest.raises(EOFError):
            reader.next(300.0)
    reader.close()


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
