"""The queue in which facts wait for the core's worker: whose turn it is, and that a node without room waits."""

import threading

import pytest

from rosoclingo.nodes.core.fact_queue import MOST_WAITING, FactQueue, Sent


@pytest.fixture
def queue():
    return FactQueue()


def put(queue, node, *facts):
    return queue.put(Sent(node, "a", facts))


def taken(queue):
    """All that waits, in the order in which it is taken."""
    return [(one.node, *one.facts) for one in iter(queue.take, None)]


def test_facts_of_one_node_keep_their_order(queue):
    for number in range(5):
        put(queue, "/a", f"seen({number})")
    assert taken(queue) == [("/a", f"seen({number})") for number in range(5)]
    assert not queue.waiting


def test_nodes_take_turns(queue):
    for number in range(3):
        put(queue, "/loud", f"seen({number})")
    put(queue, "/quiet", "at(x)")
    put(queue, "/quiet", "at(y)")
    order = [node for node, _ in taken(queue)]
    assert order == ["/loud", "/quiet", "/loud", "/quiet", "/loud"]


def test_the_worker_is_called_for_the_first_message_only(queue):
    assert put(queue, "/a", "seen(1)")
    assert not put(queue, "/b", "seen(1)")
    taken(queue)
    assert put(queue, "/a")
    assert taken(queue) == [("/a",)]


def test_a_node_without_room_waits_and_loses_nothing(queue):
    number, sent = 3 * MOST_WAITING, []

    def send():
        for one in range(number):
            put(queue, "/loud", str(one))
            sent.append(one)

    sender = threading.Thread(target=send, daemon=True)
    sender.start()
    found = []
    while len(found) < number:
        message = queue.take()
        if message is not None:
            found += map(int, message.facts)
        assert len(sent) <= len(found) + MOST_WAITING
    assert found == list(range(number))
    sender.join()
    assert put(queue, "/quiet", "at(x)"), "there is room for others"
