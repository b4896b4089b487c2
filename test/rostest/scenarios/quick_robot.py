#!/usr/bin/env python3
"""A robot without a simulated drive: simulated time, the doors, and a move_base that takes some seconds.

It stands in for simulator, localization and move_base, which compute most of the time that a played scenario takes.
"""

import sys
import threading
from pathlib import Path

import rospy
import tf2_ros
from actionlib.action_server import ActionServer
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction
from rosgraph_msgs.msg import Clock
from rosoclingo.srv import SetDoor, SetDoorResponse, SetSpeed, SetSpeedResponse

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / folder) for folder in ("rostest", "unit")]

from interface_helpers import base_at  # noqa: E402

TICK = 0.1  # seconds of wall time
DRIVE = 6.0  # simulated seconds of each drive
HALF = 7.925  # metres: x of the doors between the two halves of the office
BETWEEN = {"corridor", "meeting_west"}  # with these doors closed there is no way from one half to the other


class QuickRobot:
    """Reaches each target after DRIVE seconds, unless doors are closed on the way."""

    def __init__(self):
        self._closed, self._speed, self._now, self._drives = set(), 1.0, 1.0, []
        self._lock = threading.RLock()
        self._clock = rospy.Publisher("/clock", Clock, queue_size=10)
        self._broadcaster = tf2_ros.StaticTransformBroadcaster()
        self._stand(*rospy.get_param("~start"))
        self._server = ActionServer("move_base", MoveBaseAction, self._begin, self._cancel, auto_start=False)
        self._server.start()
        self._services = [
            rospy.Service("~set_speed", SetSpeed, self._set_speed),
            rospy.Service("~set_door", SetDoor, self._set_door),
        ]

    def run(self):
        """Let time pass."""
        ticks = threading.Event()
        rospy.on_shutdown(ticks.set)
        while not ticks.wait(TICK):
            with self._lock:
                self._now += TICK * self._speed
                self._clock.publish(Clock(rospy.Time.from_sec(self._now)))
                for end, handle in self._drives[:]:
                    if end <= self._now:
                        self._drives.remove((end, handle))
                        self._arrive(handle)

    def _stand(self, x, y):
        self._x = x
        self._broadcaster.sendTransform(base_at(x, y))

    def _begin(self, handle):
        with self._lock:
            handle.set_accepted()
            self._drives.append((self._now + DRIVE, handle))

    def _cancel(self, handle):
        with self._lock:
            self._drives = [one for one in self._drives if one[1] != handle]
            handle.set_canceled()

    def _arrive(self, handle):
        if handle.get_goal_status().status != GoalStatus.ACTIVE:
            return
        place = handle.get_goal().target_pose.pose.position
        if self._closed >= BETWEEN and (self._x < HALF) != (place.x < HALF):
            handle.set_aborted(text="Failed to find a valid plan.")
        else:
            self._stand(place.x, place.y)
            handle.set_succeeded()

    def _set_speed(self, request):
        self._speed = request.speed
        return SetSpeedResponse(success=True)

    def _set_door(self, request):
        with self._lock:
            (self._closed.discard if request.open else self._closed.add)(request.door)
        return SetDoorResponse(success=True)


if __name__ == "__main__":
    rospy.init_node("simulator")
    QuickRobot().run()
