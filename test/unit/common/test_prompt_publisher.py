"""Connections that send at once: nobody waits for a slow subscriber, and what arrives is whole messages in order."""

import socket
import struct
import threading

import pytest

tcpros_base = pytest.importorskip("rospy.impl.tcpros_base")
from rosoclingo.common.prompt_publisher import PromptConnection  # noqa: E402

SIZE = 10000
PATIENCE = 120.0  # seconds of wall time


class Protocol:
    """What a transport wants to know of its protocol."""

    buff_size = 65536
    direction = "o"


def pair(queue_size=5):
    """A connection, and the socket at the subscriber's end."""
    near, far = socket.socketpair()
    far.settimeout(PATIENCE)
    transport = tcpros_base.TCPROSTransport(Protocol(), "topic")
    transport.set_socket(near, "subscriber")
    return PromptConnection(transport, queue_size), far


def message(number):
    return struct.pack("<I", number) * (SIZE // 4)


def publish_for_ever(connection):
    while True:
        connection.write_data(message(0))


def read(far, count):
    """The numbers of the next messages; fails where one is not whole."""
    numbers = []
    for _ in range(count):
        data = b""
        while len(data) < SIZE:
            data += far.recv(SIZE - len(data))
        numbers.append(struct.unpack("<I", data[:4])[0])
        assert data == message(numbers[-1])
    return numbers


def test_a_message_is_there_when_publishing_returns():
    connection, far = pair()
    before = set(threading.enumerate())
    far.setblocking(False)
    for number in range(3):
        assert connection.write_data(message(number))
        assert far.recv(SIZE) == message(number)
    assert set(threading.enumerate()) <= before, "no thread has a hand in it"
    assert connection.stat_num_msg == 3
    assert connection.stat_bytes == 3 * SIZE
    connection.close()


def test_a_suspended_subscriber_costs_old_messages_only():
    connection, far = pair(queue_size=5)
    for number in range(200):  # more than any socket buffers, and nobody reads
        connection.write_data(message(number))
    first = read(far, 1)
    numbers = first
    while numbers[-1] < 199:
        numbers += read(far, 1)
    assert numbers == sorted(set(numbers))
    assert numbers[-5:] == [195, 196, 197, 198, 199]
    assert len(numbers) < 200
    connection.write_data(message(200))
    assert read(far, 1) == [200]
    connection.close()


@pytest.mark.parametrize("full", [False, True])
def test_who_has_gone_is_told(full):
    connection, far = pair()
    if full:
        for number in range(200):
            connection.write_data(message(number))
    far.close()
    # the last where the thread that relays what was left over is the first to meet a socket that rospy has let go
    with pytest.raises((tcpros_base.TransportTerminated, OSError, tcpros_base.TransportInitError)):
        publish_for_ever(connection)
    connection.close()
    with pytest.raises(tcpros_base.TransportTerminated):
        connection.write_data(message(0))


def test_its_thread_ends_with_the_connection():
    before = set(threading.enumerate())
    connection, _far = pair()
    (thread,) = set(threading.enumerate()) - before
    connection.close()
    thread.join(PATIENCE)
    assert not thread.is_alive()
