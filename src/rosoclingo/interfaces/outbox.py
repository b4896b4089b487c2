"""The queue of answers to the core."""

from collections import deque
from typing import Callable, Deque, NamedTuple, Optional

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.msg import InterfaceIO

# Limit in seconds of wall time that an answer waits for its receiver to connect.
PATIENCE = 1.0

# Seconds of wall time between two announcements.
PERIOD = 1.0


class _Waiting(NamedTuple):
    message: InterfaceIO
    reader: str
    wall: float
    wanted: Optional[Callable[[], bool]]


class Outbox:
    """Publishes messages in order, each as soon as its receiver is connected.

    A node that has just started is connected in one direction before the other, and would lose an earlier answer.
    Messages bypass rospy's queue, because a node loses its queue at shutdown.
    A message with the interface's name and no facts announces the interface to each node that connects, and is repeated
    every PERIOD.
    """

    def __init__(self, topic: str, interface: str) -> None:
        self._announcement = InterfaceIO(interface=interface)
        self._publisher = prompt_publisher(topic, InterfaceIO, greeting=lambda: [self._announcement])
        self._waiting: Deque[_Waiting] = deque()
        self._announced = float("-inf")

    def put(self, message: InterfaceIO, reader: str, wall: float, wanted: Optional[Callable[[], bool]] = None) -> None:
        """Publish a message once the node `reader` is connected; `wall` is steady time in seconds.

        The message waits while ``wanted`` returns True, or without ``wanted`` for PATIENCE.
        """
        if not any(one.message == message for one in self._waiting):
            self._waiting.append(_Waiting(message, reader, wall, wanted))
        self.flush(wall)

    def flush(self, wall: float) -> bool:
        """Publish messages whose receivers are connected; return whether others still wait.  Call it often."""
        if wall - self._announced >= PERIOD:
            self._announced = wall
            self._publisher.publish(self._announcement)
        while self._waiting:
            message, reader, since, wanted = self._waiting[0]
            dropped = wanted is not None and not wanted()
            waits = wanted is not None or wall - since < PATIENCE
            if waits and not dropped and not self._publisher.impl.has_connection(reader):
                return True
            self._waiting.popleft()
            if not dropped:
                self._publisher.publish(message)
        return False
