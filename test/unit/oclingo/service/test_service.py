"""The TCP service over real sockets."""

import socket
import struct

import pytest
from service_helpers import TIMEOUT, running
from shipped import GOLDEN

from rosoclingo.oclingo.service import connection as service_client
from rosoclingo.oclingo.service import server as service

ECHO = "#cumulative t.\n#external e(t).\nc(t) :- e(t).\n#volatile t.\n"
GOAL = ECHO + ":- not c(t).\n"  # a search is endless until an update asserts e(t)


@pytest.fixture(scope="module")
def echo():
    """A service shared by tests; they must not define externals of steps below 100."""
    with running(ECHO) as found:
        yield found


@pytest.fixture
def client(echo):
    found = echo.client()
    yield found
    assert found.ask("#step 1 : 0. #endstep.").end == "end", "the connection stays usable"
    found.close()


def kill(client):
    """Reset the connection, as the kernel does for a killed process."""
    client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    client.close()


@pytest.mark.slow
@pytest.mark.parametrize("case", GOLDEN, ids=[case["name"] for case in GOLDEN])
def test_service_gives_the_answers_of_oclingo(case):
    with running(case["program"]) as found:
        client = found.client()
        for update in case["updates"]:
            reply = client.ask(update["update"])
            assert reply.sets == sorted(sorted(answer) for answer in update["answers"])
            assert reply.end == ("end" if update["end"] == "ok" else "unsat")
            assert reply.horizons == [update["horizon"]] * len(update["answers"])
            if update["end"] != "ok":
                assert reply.text == str(update["horizon"])


@pytest.mark.slow
def test_service_sends_the_exact_bytes_of_oclingo():
    program = "#base.\nc :- d(1).\n#cumulative t.\n#external e(t).\n#volatile t.\n:- not e(t).\n"
    updates = [
        "#step 1 : 0. #endstep.",
        "#step 1 : 0. e(1). d(1). #endstep.",
        "#step 2. e(X).",
        "#step 2 : 1.\n#endstep.\n",
    ]
    with running(program) as found:
        with socket.create_connection(("127.0.0.1", found.port), timeout=TIMEOUT) as connection:
            connection.sendall(b"".join(update.encode() + b"\0" for update in [*updates, "#stop."]))
            data = b"".join(iter(lambda: connection.recv(4096), b""))
        found.join()
    assert data.split(b"\0") == [
        b"Input:\n",
        b"End of Step.\n",
        b"Input:\n",
        b"UNSAT at step 1",
        b"Input:\n",
        b"Warning: Head d(1) has not been declared external. The entire rule will be ignored.\n",
        b"Step: 1\ne(1) ",
        b"End of Step.\n",
        b'Error: 1:12: X is a variable, since it begins with a capital letter: write a value, such as x or "X"',
        b"Input:\n",
        b"Input:\n",
        b"UNSAT at step 3",
        b"",
    ]


def test_service_answers_several_updates_sent_together(client):
    client.send(*[f"#step {step} : 0. #endstep." for step in range(100, 120)])
    client.send("#step 120 : 0. #endstep.\n#step 121 : 0. #endstep. #step 122. #end step.")
    assert [client.reply().horizons for _ in range(23)] == [[step] for step in range(100, 123)]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"#step 1. e(1).", "1:15: incomplete update"),
        (b"#step 1. e(\xff). #endstep.", "1:12: not UTF-8: byte 0xff"),
        (b"#step 1. e(" + b"f(" * 1000 + b"1" + b")" * 1000 + b"). #endstep.", "1:522: term nested deeper than"),
        (b"", "1:1: a message without an update"),
        (b"x" * 1_000_000, "1:1: a message of 1000000 bytes or more"),
    ],
)
def test_invalid_update_is_an_error_without_disconnection(client, data, message):
    client.socket.sendall(data + b"\0")
    reply = client.reply()
    assert reply.end == "error"
    assert reply.text.startswith(message)
    assert client.item() == "Input:\n"


def test_client_killed_during_a_message_changes_nothing(echo, client):
    before = client.ask("#step 130. e(130). #endstep.").sets
    for text in (b"#step 131. e(131)", b"#step 131. e(131). #endstep.", b"#step 131. e(131)\0"[:5]):
        other = echo.client()
        other.socket.sendall(text)
        kill(other)
    assert client.ask("#step 130. #endstep.").sets == before


@pytest.mark.slow
def test_clients_beyond_the_limit_wait(monkeypatch):
    monkeypatch.setattr(service, "CLIENT_LIMIT", 2)
    with running(ECHO) as found:
        first, second = found.client(), found.client()
        third = found.client(greeted=False)
        assert first.ask("#step 1. #endstep.").end == "end"
        second.close()
        assert third.reply().end == "end"
        third.close()


@pytest.mark.slow
def test_client_that_does_not_read_blocks_no_other(monkeypatch):
    monkeypatch.setattr(service_client, "UNSENT_LIMIT", 10_000)
    with running("#cumulative t. { p(1..6,t) }.") as found:
        slow, client = found.client(), found.client()
        count = 60
        slow.send(*["#step 1. #endstep."] * count)
        for _ in range(5):
            assert len(client.ask("#step 1. #endstep.").answers) == 64
        assert sum(len(slow.reply().answers) for _ in range(count)) == 64 * count


@pytest.mark.slow
def test_stop_closes_the_service_and_all_connections():
    with running(ECHO) as found:
        first, second = found.client(), found.client()
        first.send("#step 1. #endstep.", "#step 2. #endstep.", "#stop.", "#step 3. #endstep.")
        assert [first.reply().horizons for _ in range(2)] == [[1], [2]]
        assert first.item() is None
        assert second.item() is None
        found.join()
        with pytest.raises(OSError, match="refused"):
            found.client()


@pytest.mark.slow
def test_waiting_update_ends_an_endless_search():
    with running(GOAL, models=1) as found:
        first, second = found.client(), found.client()
        first.send("#step 1. #endstep.")
        assert first.item() == "Input:\n", "the search has begun"
        second.send("#step 1. #forget 1..1. #endstep.", "#step 1 : 0. #endstep.")
        reply = first.reply()
        assert (reply.end, reply.answers) == ("end", [])
        assert reply.warnings[0].startswith("The search for step 1 ended at horizon ")
        assert reply.warnings[0].endswith("without an answer: another update waits. The update stays in force.")
        assert second.reply().warnings, "updates of the same client interrupt a search, too"
        assert second.reply().end == "unsat"


@pytest.mark.slow
def test_update_with_endless_grounding_is_dropped():
    program = "#cumulative t.\n#external e(t).\nn(0,t) :- t > 1.\nn(X+1,t) :- n(X,t), X < 2000000000.\n"
    with running(program, time_limit=1.0) as found:
        client = found.client()
        while client.ask("#step 1. e(1). #endstep.").sets != [["e(1)"]]:  # the time limit is short for a slow machine
            pass
        reply = client.ask("#step 2. #endstep.")
        assert reply.end == "error"
        assert "ignored a stop" in reply.text
        assert "the time limit of 1 s was reached" in reply.text
        while client.ask("#step 1. #endstep.").sets != [["e(1)"]]:
            pass
