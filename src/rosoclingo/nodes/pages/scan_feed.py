"""Subscriptions to the scans of lasers, as long as a page shows them."""

import time
from functools import partial
from typing import Any, Callable, Dict

import rospy
from sensor_msgs.msg import LaserScan

#: Minimum interval in seconds of wall time between two scans of a topic.
OFTEN = 0.5

#: Seconds of wall time after the last request for which scans are subscribed.
WANTED = 12.0

#: Limit of topics.
MOST = 20


class ScanFeed:
    """Passes on scans of all topics with ``sensor_msgs/LaserScan``, as long as they are wanted.

    ``take`` is called with a topic and a scan, in threads of rospy; the methods work from any thread.
    """

    def __init__(self, take: Callable[[str, LaserScan], None]) -> None:
        self._take = take
        self._until = 0.0
        self._read: Dict[str, float] = {}
        self._subscribers: Dict[str, rospy.Subscriber] = {}

    def want(self) -> Dict[str, Any]:
        """Subscribe for some seconds; return the number of topics, or a fault if the master does not answer."""
        self._until = time.monotonic() + WANTED
        try:
            topics = [name for name, kind in rospy.get_published_topics() if kind == LaserScan._type]
        except (OSError, rospy.ROSException):
            return {"fault": "the ROS master does not answer: try again"}
        for topic in sorted(topics)[:MOST]:
            if topic not in self._subscribers:
                self._subscribers[topic] = rospy.Subscriber(
                    topic, LaserScan, partial(self._on_scan, topic), queue_size=1
                )
        return {"scans": len(topics)}

    def check(self) -> None:
        """Unsubscribe if no page wants scans any more."""
        if self._subscribers and time.monotonic() > self._until:
            for subscriber in self._subscribers.values():
                subscriber.unregister()
            self._subscribers = {}

    def _on_scan(self, topic: str, scan: LaserScan) -> None:
        now = time.monotonic()
        if now - self._read.get(topic, -OFTEN) >= OFTEN:
            self._read[topic] = now
            self._take(topic, scan)
