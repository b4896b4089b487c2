"""What each node that connects to a topic is told before anything else that is published there."""

from typing import Any, Callable, Iterable

import rospy

__all__ = ["Greeting", "greet_first"]


class Greeting(rospy.SubscribeListener):  # type: ignore[misc]
    """A `subscriber_listener` that sends a newcomer, and it alone, what ``messages`` gives then."""

    def __init__(self, messages: Callable[[], Iterable[Any]]) -> None:
        super().__init__()
        self._messages = messages

    def peer_subscribe(self, _topic: str, _publish_all: Callable[..., None], publish: Callable[..., None]) -> None:
        """Called by rospy when a subscriber has connected."""
        for message in self._messages():
            publish(message)


def greet_first(publisher: rospy.Publisher) -> None:
    """Let no message of another thread come before the greeting: rospy adds a newcomer to the listeners first."""
    impl = publisher.impl
    add = impl.add_connection

    def add_connection(connection: object) -> bool:
        with impl.publock:
            return bool(add(connection))

    impl.add_connection = add_connection
