"""The wire protocol without sockets."""

import clingo
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.oclingo import SolveOutcome, SolveResult, StreamUpdate
from rosoclingo.oclingo.service import protocol


@pytest.mark.parametrize(
    ("outcome", "answers", "warnings", "data"),
    [
        (SolveOutcome.SATISFIABLE, (["e(1)"], []), (), b"Step: 3\ne(1) \0Step: 3\n\0End of Step.\n\0"),
        (SolveOutcome.SATISFIABLE, (['-q("a b")'],), (), b'Step: 3\n-q("a b") \0End of Step.\n\0'),
        (SolveOutcome.UNSATISFIABLE, (), (), b"UNSAT at step 3\0"),
        (SolveOutcome.INTERRUPTED, (), (), b"End of Step.\n\0"),
        (
            SolveOutcome.SATISFIABLE,
            (["e"],),
            ("one\n  two\n", "three"),
            b"Warning: one; two\n\0Warning: three\n\0Step: 3\ne \0End of Step.\n\0",
        ),
    ],
)
def test_reply_has_warnings_answers_and_an_end(outcome, answers, warnings, data):
    symbols = tuple(frozenset(map(clingo.parse_term, answer)) for answer in answers)
    assert b"".join(protocol.reply(SolveResult(outcome, symbols, 3, 1, warnings))) == data


def test_error_is_one_line_followed_by_input():
    assert protocol.error("1:2: a\nb\0c") == b"Error: 1:2: a; b c\0Input:\n\0"


def test_requests_accept_updates_up_to_the_first_error():
    first, second, fault = protocol.requests(
        "#step 1. #endstep.\n#step 2. #end step. e. f(X). #endstep. #step 3. #endstep."
    )
    assert (first, second) == (StreamUpdate(1), StreamUpdate(2))
    assert (fault.line, fault.column) == (2, 26)


def feed(buffer, data):
    """Add ``data`` to the buffer and return the messages that are complete."""
    return list(buffer.add(data))


def test_requests_report_bytes_that_are_not_utf8():
    (message,) = feed(protocol.MessageBuffer(), b"#step 1.\n\xc3\xa4 \xff#endstep.\0")
    (fault,) = protocol.requests(message)
    assert str(fault) == "2:3: not UTF-8: byte 0xff, invalid start byte"


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
