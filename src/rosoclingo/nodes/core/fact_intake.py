"""The core's input of facts from the topic in_rosoclingo."""

import time
from typing import NamedTuple, Set, Tuple

import rospy

from rosoclingo.common.worker import Worker
from rosoclingo.msg import InterfaceIO
from rosoclingo.nodes.core.bounded_queue import BoundedQueue
from rosoclingo.nodes.core.gathering import Gathering
from rosoclingo.reasoning.interface_register import InterfaceRegister
from rosoclingo.reasoning.journal.resumable_core import ResumableCore
from rosoclingo.reasoning.keywords import shortened

#: Limit in seconds of wall time that the worker spends on facts before other work.
SLICE = 0.05


#: Limit of one node's queued messages.
MOST_WAITING = 20


class _Sent(NamedTuple):
    """A message of a node; without facts it announces that the node serves the interface."""

    node: str
    interface: str
    facts: Tuple[str, ...]


class FactIntake:
    """Queues facts until the worker takes them; the topic's callback only enqueues.

    Attributes:
        gathering: decides whether the next update waits for messages that were sent together.

    """

    def __init__(self, core: ResumableCore, register: InterfaceRegister, worker: Worker) -> None:
        self._core, self._register, self._worker = core, register, worker
        self._queue: BoundedQueue[_Sent] = BoundedQueue(MOST_WAITING)
        self.gathering = Gathering(time.monotonic())

    def connect(self) -> None:
        """Subscribe to facts."""
        self._inlet = rospy.Subscriber("in_rosoclingo", InterfaceIO, self._on_facts, tcp_nodelay=True)

    @property
    def waiting(self) -> bool:
        """Whether facts are queued."""
        return len(self._queue) > 0

    def gather(self) -> bool:
        """Return whether the next update waits for facts, goals or cancels."""
        return self.gathering.waits(time.monotonic(), self.waiting or self._worker.waiting)

    @property
    def senders(self) -> Set[str]:
        """The names of the nodes that can send facts."""
        return {connection.callerid_pub for connection in self._inlet.impl.connections}

    def _on_facts(self, message: InterfaceIO) -> None:
        node = message._connection_header["callerid"]
        if self._queue.put(node, _Sent(node, shortened(message.interface), tuple(message.facts))):
            self._worker.put(_wake)

    def take(self) -> None:
        """Pass queued facts to the core, for at most SLICE seconds; called by the worker."""
        end = time.monotonic() + SLICE
        while self._queue and time.monotonic() < end:
            [message] = self._queue.take(1)
            if message.facts:
                self._core.receive(message.interface, message.facts)
            else:
                self._register.announce(message.node, message.interface)


def _wake() -> None:
    """Do nothing: any job makes the worker take facts."""
