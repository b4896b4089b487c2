"""One entry of /diagnostics: the status of one part of a node."""

import time
from typing import Callable, Mapping, Optional, Tuple

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

#: Seconds of wall time between two messages, at most and at least.
PERIOD, PAUSE = 1.0, 0.1

#: A level of DiagnosticStatus, a line for people, and values by name.
Findings = Tuple[int, str, Mapping[str, object]]


class Diagnostics:
    """Publishes a status once a second and on change, in wall time, as simulated time can stand still.

    ``name`` is the name of the status; ``describe`` returns it, and is called at most ten times a second.

    Publishes:
        /diagnostics (diagnostic_msgs/DiagnosticArray)
    """

    def __init__(self, name: str, describe: Callable[[], Findings]) -> None:
        self._name = name
        self._describe = describe
        self._last: Optional[Findings] = None
        self._looked = self._published = float("-inf")
        self._publisher = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=10)

    def tick(self) -> None:
        """Publish if the status has changed or the last message is old; call this often."""
        now = time.monotonic()
        if now - self._looked < PAUSE:
            return
        self._looked = now
        found = self._describe()
        if found == self._last and now - self._published < PERIOD:
            return
        self._last, self._published = found, now
        level, text, values = found
        status = DiagnosticStatus(int(level), self._name, text, "rosoclingo", [])
        status.values = [KeyValue(key, str(value)) for key, value in values.items()]
        message = DiagnosticArray(status=[status])
        message.header.stamp = rospy.get_rostime()
        self._publisher.publish(message)
