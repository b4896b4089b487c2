"""Watchdog that stops the robot if its next command is late."""

import threading
import time
from typing import Callable

import rospy
from geometry_msgs.msg import Twist

MIN_TIMEOUT, TIMEOUT_PERIODS = 0.5, 4.0  # timeout in s and in control periods; the longer one applies
MIN_WALL_TIMEOUT, CHECK_PERIOD = 0.3, 0.1  # s of wall time; the minimum timeout is for fast simulations


class CommandWatch:
    """Publishes commands, and a stop if a command that moves the robot is not followed by another one in time.

    ``period`` (s) is the control period. Robots do not always have a watchdog of their own; Stage's is off by default.
    """

    def __init__(self, publish: Callable[[Twist], None], period: float) -> None:
        self._publish, self._limit = publish, max(MIN_TIMEOUT, TIMEOUT_PERIODS * period)
        self._lock = threading.Lock()
        self._moving = False
        self._since = (0.0, 0.0)  # wall time and ROS time of the last command
        self._ended = threading.Event()

    def start(self) -> None:
        """Start checking, in a separate thread: the worker can be blocked."""
        threading.Thread(target=self._run, name="command watch", daemon=True).start()

    def command(self, message: Twist) -> None:
        """Publish a command."""
        with self._lock:
            self._moving = bool(message.linear.x or message.angular.z)
            self._since = (time.monotonic(), rospy.get_time())
            self._publish(message)

    def end(self) -> None:
        """Stop the robot, and stop checking."""
        self._ended.set()
        self.command(Twist())

    def check(self, wall: float, now: float) -> bool:
        """Stop the robot if its next command is late at a wall time and a ROS time (s). Return whether it was."""
        with self._lock:
            late = self._moving and wall - self._since[0] > MIN_WALL_TIMEOUT and now - self._since[1] > self._limit
            if late:
                self._moving = False
                self._publish(Twist())
        return late

    def _run(self) -> None:
        while not self._ended.wait(CHECK_PERIOD):
            if self.check(time.monotonic(), rospy.get_time()):
                rospy.logwarn("no command for %.1f s: stopping the robot", self._limit)
