"""Publishers that send at once, in the thread that publishes.

rospy's own, with a queue, hand each message to a thread of each connection and then give up the processor
(``time.sleep(0)``, which takes 50 to 100 us): with a dozen subscribers that is most of a simulation step. Without a
queue rospy sends at once, but then one subscriber that has been suspended stops the node. What waits in such a queue
when the node ends is lost.
"""

import contextlib
import socket
from typing import Any, Callable, Iterable, List, Optional

import rospy
from rospy.impl.tcpros_base import TransportTerminated
from rospy.impl.tcpros_pubsub import QueuedConnection

__all__ = ["prompt_publisher"]


class PromptConnection(QueuedConnection):  # type: ignore[misc]
    """A connection that sends what the socket takes at once; its thread and its queue are for what is left over."""

    def __init__(self, connection: Any, queue_size: int) -> None:
        self._left: List[bytes] = []  # on its way: the rest of a message partly sent must never be dropped
        with contextlib.suppress(AttributeError, OSError):  # closed already, or no TCP socket
            connection.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        super().__init__(connection, queue_size)

    def write_data(self, data: bytes) -> bool:
        """Send a message, or what fits, and queue the rest. Raises TransportTerminated once it is closed."""
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
        """Return how many bytes the socket takes without waiting."""
        try:
            sent = int(self._connection.socket.send(data, socket.MSG_DONTWAIT))
        except BlockingIOError:
            return 0
        except (AttributeError, OSError) as error:  # who publishes closes the connection then
            raise TransportTerminated(str(error)) from error
        self._connection.stat_bytes += sent
        self._connection.stat_num_msg += 1
        return sent

    def _run(self) -> None:
        """Relay what is left over, and what was queued behind it."""
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


class _Greeting(rospy.SubscribeListener):  # type: ignore[misc]
    """Sends a newcomer, and it alone, the messages that ``messages`` returns then."""

    def __init__(self, messages: Callable[[], Iterable[Any]]) -> None:
        super().__init__()
        self._messages = messages

    def peer_subscribe(self, _topic: str, _publish_all: Callable[..., None], publish: Callable[..., None]) -> None:
        """Called by rospy when a subscriber has connected."""
        for message in self._messages():
            publish(message)


def prompt_publisher(
    name: str, kind: Any, queue_size: int = 100, greeting: Optional[Callable[[], Iterable[Any]]] = None, **more: Any
) -> rospy.Publisher:
    """Return a rospy.Publisher that sends at once; ``queue_size`` messages wait for a subscriber that is slow.

    Each node that connects is sent the messages of ``greeting`` before any other message. Any other publisher of the
    topic in this process shares its connections, and so sends at once too.
    """
    if greeting is not None:
        more["subscriber_listener"] = _Greeting(greeting)
    publisher = rospy.Publisher(name, kind, queue_size=queue_size, **more)
    impl = publisher.impl
    if "add_connection" not in vars(impl):
        add = impl.add_connection

        def add_connection(connection: Any) -> bool:
            """Add a connection and greet it, while no other thread publishes: rospy adds it to the listeners first."""
            with impl.publock:
                return bool(add(PromptConnection(connection, queue_size)))

        impl.add_connection = add_connection
        impl.set_queue_size(None)  # with a size it would wrap each connection once more
        impl.set_queue_size = lambda size: None
    for message in greeting() if greeting is not None else ():  # for those that connected before
        publisher.publish(message)
    return publisher
