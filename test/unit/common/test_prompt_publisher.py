"""Immediate sending: nobody waits for a slow subscriber, and subscribers receive whole messages in order."""

import socket
import struct
import threading

import pytest

tcpros_base = pytest.importorskip("rospy.impl.tcpros_base")
from rosoclingo.common.prompt_publisher import PromptConnection  # noqa: E402

SIZE = 10000
PATIENCE = 120.0  # seconds of wall time


class Protocol:
    """The parts of a protocol that a transport reads."""

    buff_size = 65536
    direction = "o"


def pair(queue_size=5):
    """Return a connection, and the socket at the subscriber's end."""
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
    """Return the numbers of the next messages; fail if a message is incomplete."""
    numbers = []
    for _ in range(count):
        data = b""
        while len(data) < SIZE:
            data += far.recv(SIZE - len(data))
        numbers.append(struct.unpack("<I", data[:4])[0])
        assert data == message(numbers[-1])
    return numbers


def test_prompt_publisher_delivers_before_publish_returns():
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


def test_prompt_publisher_drops_old_messages_for_suspended_subscriber():
    connection, far = pair(queue_size=5)
    for number in range(200):  # more than any socket buffers, without a reader
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
def test_prompt_publisher_reports_a_vanished_subscriber(full):
    connection, far = pair()
    if full:
        for number in range(200):
            connection.write_data(message(number))
    far.close()
    # in the last case the thread that relays the rest is the first to find that rospy has closed the socket
    with pytest.raises((tcpros_base.TransportTerminated, OSError, tcpros_base.TransportInitError)):
        publish_for_ever(connection)
    connection.close()
    with pytest.raises(tcpros_base.TransportTerminated):
        connection.write_data(message(0))
