"""Channels: messages arrive complete, and a sender does not block."""

import socket
import threading

import pytest

from rosoclingo.oclingo import parse_atom
from rosoclingo.planning.workers.channel import Channel

LONG = {"text": "x" * 2**21}


@pytest.fixture
def ends():
    """Yield a channel and the other end of its connection."""
    here, there = socket.socketpair()
    with there:
        there.settimeout(300.0)
        channel = Channel(here)
        yield channel, there
        channel.close()


def test_channel_joins_messages_from_pieces(ends):
    channel, there = ends
    other = Channel(there)
    for _ in range(3):
        other.send(LONG)
    while len(channel.unread) < 3:
        other.wait(0.0)
        channel.wait(0.0)
    assert list(channel.unread) == [LONG] * 3


def test_channel_reports_end_after_last_message(ends):
    channel, there = ends
    other = Channel(there)
    symbols = frozenset(map(parse_atom, ["p(1,-2)", '-q("a,b\\"")', "r(#sup,f((),g))"]))
    other.send(symbols)
    there.send(b"a part")
    assert channel.wait()
    assert channel.unread.popleft() == symbols
    assert not channel.wait(0.0)
    there.close()
    for _ in range(2):
        with pytest.raises(EOFError):
            channel.wait()
        channel.send(LONG)


def test_channel_writes_the_rest_while_waiting(ends):
    channel, there = ends
    channel.send(LONG)

    def answer():
        received = 0
        while received < 2**21:
            received += len(there.recv(2**20))
        Channel(there).send(None)

    threading.Thread(target=answer, daemon=True).start()
    assert channel.wait(300.0)
