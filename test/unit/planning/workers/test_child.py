"""The pipe to a child: what it is told is not waited for."""

import os
import signal
import threading

import pytest
from children import kill

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.workers.child import Pipes, WorkerLostError, WorkerProcess
from rosoclingo.planning.workers.wire import encode, program_to_message

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


@pytest.fixture
def ends():
    """Pipes, and their other ends: what is written to them, and what they write."""
    (unread, commands), (replies, told) = os.pipe(), os.pipe()
    pipes = Pipes(os.fdopen(commands, "wb", buffering=0), os.fdopen(replies, "rb", buffering=0))
    with os.fdopen(unread, "rb") as other, os.fdopen(told, "wb", buffering=0) as teller:
        yield pipes, other, teller
    pipes.close()


def test_what_is_told_is_read_in_whatever_pieces_it_comes(ends):
    pipes, _, teller = ends
    message = {"text": "x" * 2**21}
    writer = threading.Thread(target=lambda: (teller.write(encode(message) * 3), teller.close()), daemon=True)
    writer.start()
    assert [pipes.next(300.0) for _ in range(3)] == [message] * 3
    for _ in range(2):
        with pytest.raises(EOFError):
            pipes.next(300.0)


def test_a_long_message_is_told_though_nobody_asks_meanwhile(ends):
    pipes, _, teller = ends
    message = {"text": "x" * 2**19}
    writer = threading.Thread(target=lambda: teller.write(encode(message)), daemon=True)
    writer.start()
    writer.join(300.0)
    assert not writer.is_alive()
    assert pipes.next(0.0) == message
    assert pipes.next(0.0) is None


def test_what_did_not_fit_in_is_written_while_an_answer_is_waited_for(ends):
    pipes, other, teller = ends
    data = b"x" * 2**22
    pipes.write(data)
    assert pipes.next(0.0) is None

    def answer():
        assert other.read(len(data)) == data
        teller.write(encode({}))

    reader = threading.Thread(target=answer, daemon=True)
    reader.start()
    assert pipes.next(300.0) == {}


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
