"""The queue of arrivals for the core's worker: a node blocks while the queue is full."""

import threading

import pytest

from rosoclingo.nodes.core import bounded_queue
from rosoclingo.nodes.core.bounded_queue import BoundedQueue

LIMIT = 20


@pytest.fixture
def queue():
    return BoundedQueue(LIMIT)


def test_bounded_queue_keeps_order_of_arrival(queue):
    for number in range(3):
        queue.put("/a", number)
        queue.put("/b", -number)
    assert queue.items == [0, 0, 1, -1, 2, -2]
    assert queue.take(4) == [0, 0, 1, -1]
    assert queue.take(4) == [2, -2]
    assert not queue


def test_bounded_queue_wakes_worker_for_first_item_only(queue):
    assert queue.put("/a", 1)
    assert not queue.put("/b", 1)
    queue.take(2)
    assert queue.put("/a", 2)


def test_bounded_queue_blocks_sender_and_loses_nothing(queue):
    number, sent = 3 * LIMIT, []

    def send():
        for one in range(number):
            queue.put("/loud", one)
            sent.append(one)

    sender = threading.Thread(target=send, daemon=True)
    sender.start()
    found = []
    while len(found) < number:
        found += queue.take(1)
        assert len(sent) <= len(found) + LIMIT
    assert found == list(range(number))
    sender.join()
    assert queue.put("/quiet", 0), "there is room for others"


def test_bounded_queue_releases_sender_when_node_ends(queue, monkeypatch):
    monkeypatch.setattr(bounded_queue, "CHECK", 0.01)
    monkeypatch.setattr(bounded_queue, "ending", lambda: True)
    for one in range(LIMIT):
        queue.put("/loud", one)
    assert not queue.put("/loud", LIMIT)
    assert queue.items == list(range(LIMIT))
