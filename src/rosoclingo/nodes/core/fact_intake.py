"""The core's input of facts from the topic in_rosoclingo."""

from functools import partial
from typing import Any, Dict, NamedTuple, Set, Tuple

import rospy

from rosoclingo.common.connections import limit_silence
from rosoclingo.common.worker import Worker
from rosoclingo.msg import InterfaceIO
from rosoclingo.nodes.core.sender_limit import SenderLimit
from rosoclingo.nodes.core.topics import CoreTopics
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.interface_register import InterfaceRegister
from rosoclingo.reasoning.keywords import shortened

#: Limit of one node's waiting messages.
MOST_WAITING = 5

#: Limit of the remembered and of the waiting announcements, by node and interface.
MOST_ANNOUNCED = 10000


class _Sent(NamedTuple):
    """A message of a node; without facts it announces that the node serves the interface.

    ``connection`` is the header of its connection: one object per connection.
    """

    node: str
    interface: str
    facts: Tuple[str, ...]
    connection: Any


class FactIntake:
    """Queues facts for the worker; the topic's callback only enqueues.

    Of the announcements of an interface, only the latest waits for the worker: they wake no worker, end no search, and
    delay no facts of their node, however long a search takes. If a node announces an interface over a new connection,
    its running actions are sent again: their returns can be lost with the former connection. That can lead to a killed
    core, or rospy closes it because it has connected twice.
    """

    def __init__(self, core: Core, register: InterfaceRegister, worker: Worker, actions: CoreTopics) -> None:
        self._core, self._register, self._worker, self._actions = core, register, worker, actions
        self._limit = SenderLimit(MOST_WAITING)
        self._announcements: Dict[Tuple[str, str], _Sent] = {}  # by node and interface
        self._connections: Dict[Tuple[str, str], Any] = {}  # from each node, by node and interface

    def connect(self) -> None:
        """Subscribe to facts."""
        self._inlet = rospy.Subscriber("in_rosoclingo", InterfaceIO, self._on_facts, tcp_nodelay=True)

    @property
    def senders(self) -> Set[str]:
        """The names of the nodes that can send facts."""
        return {connection.callerid_pub for connection in self._inlet.impl.connections}

    def _on_facts(self, message: InterfaceIO) -> None:
        node = message._connection_header["callerid"]
        sent = _Sent(node, shortened(message.interface), tuple(message.facts), message._connection_header)
        if not message.facts:
            if len(self._announcements) < MOST_ANNOUNCED:
                self._announcements[node, sent.interface] = sent
        elif self._limit.enter(node):
            self._worker.put(partial(self._receive, sent))

    def _receive(self, message: _Sent) -> None:
        self._limit.leave(message.node)
        self._core.interfaces.hear(message.interface)
        self._core.receive(message.interface, message.facts)

    def announce(self) -> None:
        """Pass the announcements to the core; called by the worker."""
        for _ in range(len(self._announcements)):
            key, message = self._announcements.popitem()
            self._register.announce(*key)
            self._core.interfaces.announce(message.interface)
            known = key in self._connections or len(self._connections) < MOST_ANNOUNCED
            if known and message.connection is not self._connections.get(key):
                self._connections[key] = message.connection
                limit_silence(self._inlet, message.connection)
                if message.node in self._actions.listeners:
                    self._actions.send_again(message.interface)
