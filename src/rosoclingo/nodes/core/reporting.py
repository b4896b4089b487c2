"""The core's state on /diagnostics and its problems in the log."""

import time
from typing import Callable

import rospy

from rosoclingo.common.diagnostics import Diagnostics
from rosoclingo.reasoning import PlanMade, Problem
from rosoclingo.reasoning.core_state import Health, Report


class CoreHealth:
    """The core's state, described in wall time, as simulated time may stand still."""

    def __init__(self, describe: Callable[[Health, float], Report]) -> None:
        self._health = Health()
        name = rospy.get_name().strip("/") + ": core"
        self._diagnostics = Diagnostics(name, lambda: describe(self._health, time.monotonic()))

    def plan_made(self, event: PlanMade) -> None:
        """Record an answer."""
        self._health.plan_made(event)

    def problem(self, event: Problem) -> None:
        """Log a problem, unless it was logged before."""
        line = self._health.problem(event, time.monotonic())
        if line:
            rospy.logwarn("%s", line)

    def tick(self) -> None:
        """Publish what has changed; to be called often."""
        for line in self._health.counted(time.monotonic()):
            rospy.logwarn("%s", line)
        self._diagnostics.tick()
