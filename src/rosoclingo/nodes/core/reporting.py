"""The core's state on /diagnostics and its problems in the log."""

import time
from typing import Callable, Optional

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from rosoclingo.reasoning import PlanMade, Problem
from rosoclingo.reasoning.core_state import Health, Report

#: Seconds of wall time between two messages, at most and at least.
PERIOD, PAUSE = 1.0, 0.1


class CoreHealth:
    """Publishes once a second and on change. Time is wall time, as simulated time may stand still."""

    def __init__(self, describe: Callable[[Health, float], Report]) -> None:
        self._describe = describe
        self._health = Health()
        self._last: Optional[Report] = None
        self._published = float("-inf")
        self._publisher = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=10)

    def plan_made(self, event: PlanMade) -> None:
        """There is an answer."""
        self._health.plan_made(event)

    def problem(self, event: Problem) -> None:
        """Something is wrong: it goes to the log, unless it was said before."""
        line = self._health.problem(event, time.monotonic())
        if line:
            rospy.logwarn("%s", line)

    def tick(self) -> None:
        """Publish if something has changed or the last message is old; to be called often."""
        now = time.monotonic()
        if now - self._published < PAUSE:
            return
        for line in self._health.counted(now):
            rospy.logwarn("%s", line)
        report = self._describe(self._health, now)
        if report == self._last and now - self._published < PERIOD:
            return
        self._last, self._published = report, now
        status = DiagnosticStatus(
            name=rospy.get_name().strip("/") + ": core", hardware_id="rosoclingo", message=report.message
        )
        status.level = int(report.level)
        status.values = [KeyValue(key, value) for key, value in report.values.items()]
        message = DiagnosticArray(status=[status])
        message.header.stamp = rospy.get_rostime()
        self._publisher.publish(message)
