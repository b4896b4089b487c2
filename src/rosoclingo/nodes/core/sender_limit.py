"""A limit of the messages of each sending node that wait for the core's worker."""

import threading
from collections import Counter

from rosoclingo.common.worker import ending

#: Seconds of wall time between two checks for the node's shutdown while a sender waits for space.
CHECK = 1.0


class SenderLimit:
    """Counts the waiting messages of each node, at most ``limit``.

    The thread of a node at its limit waits in ``enter``. Meanwhile its connection is not read, so TCP slows the node
    down. Only messages that wait there when this node shuts down are lost.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._changed = threading.Condition()
        self._number: Counter[str] = Counter()

    def enter(self, node: str) -> bool:
        """Count a message of a node, once there is space; return False if this node shuts down before."""
        with self._changed:
            while not self._changed.wait_for(lambda: self._number[node] < self._limit, CHECK):
                if ending():
                    return False
            self._number[node] += 1
            return True

    def leave(self, node: str) -> None:
        """Count a message of a node as taken."""
        with self._changed:
            self._number -= Counter([node])  # removes nodes without messages
            self._changed.notify_all()
