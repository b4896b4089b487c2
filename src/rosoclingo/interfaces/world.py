"""The last message of a topic that says how the world is."""

import functools
from typing import Any

import rospy

from rosoclingo.common.connections import is_connected


class Watch:
    """Remembers the last message of a topic, as long as who sent it is there: what a dead node said may be over."""

    def __init__(self, topic: str, kind: type) -> None:
        self._last: Any = None
        self._subscriber = rospy.Subscriber(topic, kind, self._note)

    def _note(self, message: Any) -> None:
        self._last = message

    @property
    def latest(self) -> Any:
        """The message; None before the first, and where its publisher is gone."""
        message = self._last
        there = message is not None and is_connected(self._subscriber, message._connection_header)
        return message if there else None


@functools.lru_cache(maxsize=None)
def watch(topic: str, kind: type) -> Watch:
    """The one watch of a topic in this process: a latched message comes once for the node."""
    return Watch(topic, kind)
