"""A queue of messages for the core's worker, with a limit for each sending node."""

import threading
from collections import Counter, deque
from typing import Deque, Generic, List, Tuple, TypeVar

from rosoclingo.common.worker import ending

#: Seconds of wall time between two checks for the node's shutdown while a sender waits for space.
CHECK = 1.0

T = TypeVar("T")


class BoundedQueue(Generic[T]):
    """Items in the order of their arrival, put by rospy's threads and taken by the worker.

    The thread of a node with ``limit`` queued items waits in ``put``. Meanwhile its connection is not read, so TCP
    slows the node down. Only items that wait for space when this node shuts down are lost.
    """

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._changed = threading.Condition()
        self._items: Deque[Tuple[str, T]] = deque()
        self._number: Counter[str] = Counter()

    def __len__(self) -> int:
        return len(self._items)

    @property
    def items(self) -> List[T]:
        """The queued items."""
        with self._changed:
            return [item for _, item in self._items]

    def put(self, node: str, item: T) -> bool:
        """Queue an item of a node; return True if the queue was empty, so that the caller has to wake the worker."""
        with self._changed:
            while not self._changed.wait_for(lambda: self._number[node] < self._limit, CHECK):
                if ending():
                    return False
            self._items.append((node, item))
            self._number[node] += 1
            return len(self._items) == 1

    def take(self, limit: int) -> List[T]:
        """Remove and return the oldest items, at most ``limit``."""
        with self._changed:
            taken = [self._items.popleft() for _ in range(min(limit, len(self._items)))]
            self._number -= Counter(node for node, _ in taken)  # removes nodes without items
            self._changed.notify_all()
            return [item for _, item in taken]
