"""The wire protocol without sockets."""

from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.oclingo import StreamUpdate
from rosoclingo.oclingo.service import protocol


def feed(buffer, data):
    """Add ``data`` to the buffer and return the messages that are complete."""
    return list(buffer.add(data))


def test_long_message_is_dropped_once_up_to_its_end():
    buffer = protocol.MessageBuffer()
    assert feed(buffer, b"x" * (protocol.MESSAGE_LIMIT - 1)) == []
    (fault,) = feed(buffer, b"x")
    assert "1:1: a message of 1000000 bytes or more" in str(fault)
    assert feed(buffer, b"x" * protocol.MESSAGE_LIMIT) == []
    assert feed(buffer, b"yz\0good\0") == ["good"]
    assert feed(buffer, b"x" * (protocol.MESSAGE_LIMIT - 1) + b"\0") == ["x" * (protocol.MESSAGE_LIMIT - 1)]


@given(st.binary(max_size=200), st.lists(st.integers(0, 200)))
def test_message_buffer_joins_pieces_of_messages(data, cuts):
    edges = sorted({0, len(data), *(cut for cut in cuts if cut < len(data))})
    buffer = protocol.MessageBuffer()
    received = [message for start, end in zip(edges, edges[1:]) for message in feed(buffer, data[start:end])]
    assert list(map(str, received)) == list(map(str, feed(protocol.MessageBuffer(), data)))
    assert len(received) == data.count(0)


@given(st.one_of(st.text(), st.text('#step endstop.123:-abcX(),"%* \n', max_size=60)))
def test_requests_yield_updates_and_at_most_one_error(text):
    found = list(protocol.requests(text))
    assert found
    assert all(isinstance(one, StreamUpdate) for one in found[:-1])
