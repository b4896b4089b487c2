"""Facts that wait for the core's worker."""

import threading
from collections import OrderedDict, deque
from typing import Deque, NamedTuple, Optional, Tuple

#: Limit of one node's queued messages.
MOST_WAITING = 20


class Sent(NamedTuple):
    """A message of a node; without facts it announces that the node serves the interface."""

    node: str
    interface: str
    facts: Tuple[str, ...]


class FactQueue:
    """The messages of all nodes, put by rospy's threads and taken by the worker.

    Messages of one node keep their order, and the nodes take turns. A node with MOST_WAITING queued messages waits in
    ``put``: its connection is not read meanwhile, so TCP slows it down, and nothing is lost here.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._lines: OrderedDict[str, Deque[Sent]] = OrderedDict()

    @property
    def waiting(self) -> bool:
        """Whether a message is queued."""
        return bool(self._lines)

    def put(self, message: Sent) -> bool:
        """Queue a message; return True if the queue was empty before, so the worker has to be called."""
        with self._changed:
            self._changed.wait_for(lambda: len(self._lines.get(message.node, ())) < MOST_WAITING)
            was_empty = not self._lines
            self._lines.setdefault(message.node, deque()).append(message)
            return was_empty

    def take(self) -> Optional[Sent]:
        """Return the next message, None if the queue is empty."""
        with self._changed:
            if not self._lines:
                return None
            node, line = self._lines.popitem(last=False)
            if len(line) > 1:
                self._lines[node] = line
            self._changed.notify_all()
            return line.popleft()
