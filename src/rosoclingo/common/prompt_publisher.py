"""Publishers that send immediately, in the publishing thread.

With a queue, rospy hands each message to a thread of each connection and then yields the processor
(``time.sleep(0)``, which takes 50 to 100 us). With a dozen subscribers this is most of a simulation step, and a node
that shuts down loses the queued messages. Without a queue, rospy sends immediately, but a suspended subscriber blocks
the node.
"""

import contextlib
import socket
from typing import Any, Callable, Iterable, List, Optional

import rospy
from rospy.impl.tcpros_base import TransportTerminated
from rospy.impl.tcpros_pubsub import QueuedConnection

from rosoclingo.common.connections import close_dead


class PromptConnection(QueuedConnection):  # type: ignore[misc]
    """A connection that sends immediately; its thread and queue serve the bytes that the socket does not accept."""

    def __init__(self, connection: Any, queue_size: int) -> None:
        self._left: List[bytes] = []  # the rest of a partly sent message must never be dropped
        with contextlib.suppress(AttributeError, OSError):  # already closed, or no TCP socket
            connection.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        super().__init__(connection, queue_size)

    def write_data(self, data: bytes) -> bool:
        """Send a message and queue the bytes that do not fit.  Raises TransportTerminated on a closed connection."""
        if self._connection.done or self._connection.socket is None:
            raise TransportTerminated("connection closed")
        with self._lock:
            if not (self._queue or self._left or self._error):
                sent = self._send(data)
                if sent < len(data):
                    self._left.append(data[sent:])
                    self._cond_data_available.notify()
                return True
        return bool(super().write_data(data))

    def _send(self, data: bytes) -> int:
        """Send without blocking; return the number of bytes that the socket accepted."""
        try:
            sent = int(self._connection.socket.send(data, socket.MSG_DONTWAIT))
        except BlockingIOError:
            return 0
        except (AttributeError, OSError) as error:  # makes rospy close the connection
            raise TransportTerminated(str(error)) from error
        self._connection.stat_bytes += sent
        self._connection.stat_num_msg += 1
        return sent

    def _run(self) -> None:
        """Send the remaining bytes and the messages queued after them."""
        while not self._connection.done:
            with self._lock:
                while not (self._queue or self._left or self._connection.done):
                    self._cond_data_available.wait()
                self._left += self._queue
                self._queue = []
            for data in self._left:
                try:
                    self._connection.write_data(data)
                except Exception as error:  # noqa: BLE001 the next publish raises it, as in rospy
                    with self._lock:
                        self._error = error
            with self._lock:
                self._left = []


def prompt_publisher(
    name: str, kind: Any, queue_size: int = 100, greeting: Optional[Callable[[], Iterable[Any]]] = None, **more: Any
) -> rospy.Publisher:
    """Return a rospy.Publisher that sends immediately; at most ``queue_size`` messages wait for a slow subscriber.

    A node that connects receives the messages of ``greeting`` first. A dead connection of such a publisher is closed,
    so that the node can connect again. All publishers of the topic in this process share the connections, so they send
    immediately too.
    """
    publisher = rospy.Publisher(name, kind, queue_size=queue_size, **more)
    impl = publisher.impl
    greetings = vars(impl).setdefault("greetings", [])
    if "add_connection" not in vars(impl):
        add = impl.add_connection

        def add_connection(connection: Any) -> bool:
            """Add and greet a connection under the lock, before other threads can publish to it."""
            if greetings:
                close_dead(connection)
            prompt = PromptConnection(connection, queue_size)
            with impl.publock:
                added = bool(add(prompt))
                for message in (one for greet in greetings for one in greet()):
                    impl.publish(message, connection_override=prompt)
                return added

        impl.add_connection = add_connection
        impl.set_queue_size(None)  # a size would make rospy wrap each connection again
        impl.set_queue_size = lambda size: None
    greetings += [greeting] if greeting is not None else []
    for message in greeting() if greeting is not None else ():  # for nodes that are already connected
        publisher.publish(message)
    return publisher
