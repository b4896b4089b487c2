"""The queue in which facts wait for the core's worker: whose turn it is, and what there is no room for."""

import pytest

from rosoclingo.nodes.core import fact_queue
from rosoclingo.nodes.core.fact_queue import MOST_KINDS, MOST_RETURNS, FactQueue, Ignored
from rosoclingo.reasoning.keywords import LONGEST
from rosoclingo.reasoning.returns import MOST_FACTS

NAMES = {"_return", "seen", "at"}


@pytest.fixture
def queue(monkeypatch):
    """A queue that has room for few facts."""
    monkeypatch.setattr(fact_queue, "MOST_WAITING", 10)
    monkeypatch.setattr(fact_queue, "MOST_TEXT", 200)
    return FactQueue(NAMES)


def taken(queue):
    """All that waits, in the order in which it is taken."""
    messages = iter(queue.take, None)
    return [(one.node, *one.facts) for one in messages]


def test_facts_of_one_node_keep_their_order(queue):
    for number in range(5):
        queue.put("/a", "a", [f"seen({number})"])
    assert taken(queue) == [("/a", f"seen({number})") for number in range(5)]


def test_nodes_take_turns(queue):
    for number in range(3):
        queue.put("/loud", "a", [f"seen({number})"])
    queue.put("/quiet", "b", ["at(x)"])
    assert ("/quiet", "at(x)") in taken(queue)[:2]


def test_a_node_that_sent_a_return_comes_sooner_but_not_for_ever(queue):
    for node in ("/a", "/b", "/c"):
        queue.put(node, "a", ["seen(1)"])
    queue.put("/d", "d", ["at(x)"])
    queue.put("/d", "d", ["_return(d,1,1)"])
    queue.put("/d", "d", [" _return ( d , 2 , 1 ) "])
    order = taken(queue)
    assert order[0] == ("/d", "at(x)"), "what it has said before comes first"
    assert order[:5:2] == [("/d", "at(x)"), ("/d", "_return(d,1,1)"), ("/d", " _return ( d , 2 , 1 ) ")]
    assert order[1] == ("/a", "seen(1)"), "every other turn is for anyone"


def test_the_worker_is_called_for_the_first_message_only(queue):
    assert queue.put("/a", "a", ["seen(1)"])
    assert not queue.put("/b", "b", ["seen(1)"])
    taken(queue)
    assert queue.put("/a", "a", ["seen(2)"])


@pytest.mark.parametrize("text", ["reading(1)", "garbage((", "", "(", "1", "Seen(1)", "\udcff", "not seen(1)", "-at2"])
def test_what_no_external_has_the_name_of_is_counted_alone(text, queue):
    assert not queue.put("/a", "a", [text] * 7)
    assert not queue.waiting
    (ignored,) = queue.take_ignored()
    assert (ignored.interface, ignored.text, ignored.times) == ("a", text, 7)
    assert queue.take_ignored() == []


@pytest.mark.parametrize("text", ["seen", " -seen(1)", "- at(1).", "%* why *% seen(1)", "% why\nseen(1)", "-%**%at"])
def test_what_may_be_declared_is_looked_at_by_the_worker(text, queue):
    queue.put("/a", "a", [text])
    assert taken(queue) == [("/a", text)]
    assert queue.take_ignored() == []


def test_a_message_of_which_nothing_is_left_announces_no_interface(queue):
    queue.put("/a", "a", ["reading(1)"])
    assert queue.take() is None
    queue.put("/a", "a", [])
    assert taken(queue) == [("/a",)]


def test_a_node_has_room_for_so_many_facts(queue):
    queue.put("/a", "a", [f"seen({number})" for number in range(8)])
    queue.put("/a", "a", ["at(1)", "at(2)", "at(3)", "_return(a,1,1)", "at(4)"])
    queue.put("/b", "b", ["at(1)"])
    assert [one[1:] for one in taken(queue) if one[0] == "/a"][1] == ("at(1)", "at(2)", "_return(a,1,1)")
    (ignored,) = queue.take_ignored()
    assert ignored == Ignored("a", "at(4)", "too much of /a is queued", 2)
    queue.put("/a", "a", ["at(5)"])
    assert taken(queue) == [("/a", "at(5)")], "there is room again"


def test_a_node_has_room_for_so_much_text(queue):
    queue.put("/a", "a", ["seen({})".format("x" * 90)] * 5)
    queue.put("/a", "a", ["_return(a,1,1)"])
    assert [len(one[1:]) for one in taken(queue)] == [2, 1]
    assert queue.take_ignored()[0].times == 3


def test_returns_are_bounded_as_well(queue):
    for number in range(MOST_RETURNS + 100):
        queue.put("/a", "a", [f"_return(a,{number},1)"])
    assert len(taken(queue)) == 10 + MOST_RETURNS
    assert queue.take_ignored()[0].times == 90


def test_announcements_are_bounded_as_well(queue):
    for number in range(100):
        queue.put("/a", f"a{number}", [])
    assert len(taken(queue)) == 10


def test_the_end_of_a_long_message_and_a_long_fact_are_ignored():
    queue = FactQueue(NAMES)
    queue.put("/a", "a", ["seen(1)"] * (MOST_FACTS + 5))
    assert [len(one[1:]) for one in taken(queue)] == [MOST_FACTS]
    (ignored,) = queue.take_ignored()
    assert f"of {MOST_FACTS + 5} facts in one message from 'a'" in ignored.why
    queue.put("/a", "a", ["seen({})".format("x" * 10 * LONGEST)])
    assert not queue.waiting
    assert len(queue.take_ignored()[0].text) == LONGEST + 1


def test_the_count_of_what_is_ignored_is_right_however_many_kinds_there_are(queue):
    for number in range(3 * MOST_KINDS):
        queue.put("/a", f"a{number}", [f"unknown{number}(1)"])
    ignored = queue.take_ignored()
    assert len(ignored) <= MOST_KINDS + 1
    assert sum(one.times for one in ignored) == 3 * MOST_KINDS
