"""Answers on their way to the core."""

from collections import deque
from typing import Deque, Tuple

import rospy

from rosoclingo.msg import InterfaceIO

# Seconds of wall time that an answer waits for the node that asked to be connected.
PATIENCE = 1.0


class Outbox:
    """Publishes messages in order, each as soon as the node that is to read it is connected.

    A node that has just started is connected in one direction before the other; an answer sent then would be lost.
    """

    def __init__(self, topic: str) -> None:
        self._publisher = rospy.Publisher(topic, InterfaceIO, queue_size=100)
        self._waiting: Deque[Tuple[InterfaceIO, str, float]] = deque()

    def put(self, message: InterfaceIO, reader: str, wall: float) -> None:
        """Publish now or, while `reader` (a node's name) is not connected, later; `wall` is steady time in seconds."""
        self._waiting.append((message, reader, wall))
        self.flush(wall)

    def flush(self, wall: float) -> bool:
        """Publish what can be published; True if something still waits."""
        while self._waiting:
            message, reader, since = self._waiting[0]
            if not self._publisher.impl.has_connection(reader) and wall - since < PATIENCE:
                return True
            self._waiting.popleft()
            self._publisher.publish(message)
        return False
