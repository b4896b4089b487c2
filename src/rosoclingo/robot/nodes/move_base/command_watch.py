"""Stops a robot whose next command does not come in time, as whatever gives it is held up."""

import threading
import time
from typing import Callable

import rospy
from geometry_msgs.msg import Twist

LEAST, PERIODS = 0.5, 4.0  # s, and periods of control, that a command may be late
WALL, EVERY = 0.3, 0.1  # s of wall time: late by less is not late, however fast simulated time runs; between two looks


class CommandWatch:
    """Publishes commands, and a stop where none follows one that moves the robot; ``period`` (s) is that of control.

    Robots have watchdogs of their own, or not; Stage's is off by default.
    """

    def __init__(self, publish: Callable[[Twist], None], period: float) -> None:
        self._publish, self._limit = publish, max(LEAST, PERIODS * period)
        self._lock = threading.Lock()
        self._moving = False
        self._since = (0.0, 0.0)  # of the last command: wall time and ROS time
        self._ended = threading.Event()

    def start(self) -> None:
        """Begin to look, in a thread of its own: the worker is what may be held up."""
        threading.Thread(target=self._run, name="command watch", daemon=True).start()

    def command(self, message: Twist) -> None:
        """Publish a command."""
        with self._lock:
            self._moving = bool(message.linear.x or message.angular.z)
            self._since = (time.monotonic(), rospy.get_time())
            self._publish(message)

    def end(self) -> None:
        """Stop the robot for good."""
        self._ended.set()
        self.command(Twist())

    def look(self, wall: float, now: float) -> bool:
        """Stop the robot if its next command is late at a wall time and a ROS time (s); tell whether it was."""
        with self._lock:
            late = self._moving and wall - self._since[0] > WALL and now - self._since[1] > self._limit
            if late:
                self._moving = False
                self._publish(Twist())
        return late

    def _run(self) -> None:
        while not self._ended.wait(EVERY):
            if self.look(time.monotonic(), rospy.get_time()):
                rospy.logwarn("no command for %.1f s: the robot is stopped", self._limit)
