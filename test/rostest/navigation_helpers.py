"""Shared by the tests of simulator and navigation."""

import math
import threading

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus
from interface_helpers import PATIENCE, wait_to_hear
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry
from std_msgs.msg import String

SUCCEEDED, ABORTED, PREEMPTED = GoalStatus.SUCCEEDED, GoalStatus.ABORTED, GoalStatus.PREEMPTED


def pose_goal(x, y, yaw=0.0, frame="map"):
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = frame
    goal.target_pose.pose.position.x, goal.target_pose.pose.position.y = x, y
    goal.target_pose.pose.orientation.z, goal.target_pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return goal


class SteadyClient(actionlib.SimpleActionClient):
    """A SimpleActionClient that receives messages before ``send_goal`` has returned; actionlib's own drops them."""

    def __init__(self, name, action):
        self._sending = threading.RLock()
        super().__init__(name, action)

    def send_goal(self, *arguments, **callbacks):
        with self._sending:
            super().send_goal(*arguments, **callbacks)

    def _handle_transition(self, handle):
        with self._sending:
            super()._handle_transition(handle)


class Driver:
    """A move_base client that knows the robot's true position and its collisions."""

    def __init__(self, prefix=""):
        self._changed = threading.Condition()
        self.pose = self.speed = None
        self.collisions = []
        self.stops = 0  # number of stops
        self.feedback = 0
        rospy.Subscriber(prefix + "base_pose_ground_truth", Odometry, self._on_truth)
        self.prefix = prefix
        collisions = rospy.Subscriber("/simulator/collisions", String, lambda one: self.collisions.append(one.data))
        self.client = SteadyClient(prefix + "move_base", MoveBaseAction)
        while not self.client.wait_for_server(rospy.Duration(5.0)):
            if rospy.is_shutdown():
                raise RuntimeError("the test was ended before move_base was there")
        own = self.client.action_client
        wait_to_hear(own.status_sub, own.feedback_sub, own.result_sub, collisions)
        self.wait(lambda: self.pose is not None)

    def _on_truth(self, message):
        position, rotation = message.pose.pose.position, message.pose.pose.orientation
        with self._changed:
            self.pose = (position.x, position.y, 2.0 * math.atan2(rotation.z, rotation.w))
            twist, before = message.twist.twist, self.speed
            self.speed = (math.hypot(twist.linear.x, twist.linear.y), twist.angular.z)
            self.stops += self.speed == (0.0, 0.0) != before
            self._changed.notify_all()

    def wait(self, condition, limit=PATIENCE):
        """Wait for a condition, evaluated at each pose; fail after ``limit`` s of wall time."""
        with self._changed:
            if not self._changed.wait_for(condition, timeout=limit):
                raise AssertionError(f"nothing happened within {limit} s")

    def send(self, goal):
        self.client.send_goal(goal, feedback_cb=self._on_feedback)

    def _on_feedback(self, _):
        self.feedback += 1

    def end(self, limit=600.0):
        """Return (status, text) of the goal's end; the limit is simulated time."""
        if not self.client.wait_for_result(rospy.Duration(limit)):
            raise AssertionError(f"the goal did not end within {limit} simulated s")
        return self.client.get_state(), self.client.get_goal_status_text()

    def drive(self, *args, **kwargs):
        self.send(pose_goal(*args, **kwargs))
        return self.end()

    def distance(self, x, y):
        return math.hypot(self.pose[0] - x, self.pose[1] - y)
