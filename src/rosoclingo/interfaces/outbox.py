"""The queue of answers to the core."""

from collections import deque
from typing import Callable, Deque, NamedTuple, Optional

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.msg import InterfaceIO

# Seconds of wall time that an answer waits for the node that asked to be connected.
PATIENCE = 1.0


class _Waiting(NamedTuple):
    message: InterfaceIO
    reader: str
    wall: float
    wanted: Optional[Callable[[], bool]]


class Outbox:
    """Publishes messages in order, each as soon as the node that is to read it is connected, and at once.

    What an interface says when it ends must not wait in a queue of rospy's, which ends with the node.

    A node that has just started is connected in one direction before the other; an answer sent then would be lost.
    Each node that connects gets the interface's name.
    """

    def __init__(self, topic: str, interface: str) -> None:
        announcement = InterfaceIO(interface=interface)
        self._publisher = prompt_publisher(topic, InterfaceIO, greeting=lambda: [announcement])
        self._waiting: Deque[_Waiting] = deque()

    def put(self, message: InterfaceIO, reader: str, wall: float, wanted: Optional[Callable[[], bool]] = None) -> None:
        """Publish now or, while `reader` (a node's name) is not connected, later; `wall` is steady time in seconds.

        With ``wanted``, the message waits until it is published or no longer wanted: a reader that is back asks again.
        Without, it waits for PATIENCE.
        """
        if not any(one.message == message for one in self._waiting):
            self._waiting.append(_Waiting(message, reader, wall, wanted))
        self.flush(wall)

    def flush(self, wall: float) -> bool:
        """Publish what can be published; True if something still waits."""
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
