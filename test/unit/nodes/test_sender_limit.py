"""The limit of waiting messages: a node blocks at its limit, other nodes do not."""

import threading
from collections import deque

import pytest

from rosoclingo.nodes.core import sender_limit
from rosoclingo.nodes.core.sender_limit import SenderLimit

LIMIT = 20


@pytest.fixture
def limit():
    return SenderLimit(LIMIT)


def test_sender_limit_blocks_sender_and_loses_nothing(limit):
    number, sent, queue = 3 * LIMIT, [], deque()

    def send():
        for one in range(number):
            limit.enter("/loud")
            queue.append(one)
            sent.append(one)

    sender = threading.Thread(target=send, daemon=True)
    sender.start()
    found = []
    while len(found) < number:
        if queue:
            found.append(queue.popleft())
            limit.leave("/loud")
        assert len(sent) <= len(found) + LIMIT
    assert found == list(range(number))
    sender.join()
    assert limit.enter("/quiet"), "there is room for others"


def test_sender_limit_releases_sender_when_node_ends(limit, monkeypatch):
    monkeypatch.setattr(sender_limit, "CHECK", 0.01)
    monkeypatch.setattr(sender_limit, "ending", lambda: True)
    for _ in range(LIMIT):
        assert limit.enter("/loud")
    assert not limit.enter("/loud")
