"""The account of a run as a node: it listens to public topics only."""

import threading
from typing import Any, Callable, Dict, Optional

import rospy
from actionlib_msgs.msg import GoalID, GoalStatusArray
from nav_msgs.msg import Odometry
from std_msgs.msg import String

from rosoclingo.common.connections import comes_to
from rosoclingo.common.labels import LabelTable
from rosoclingo.msg import InterfaceIO, PackageStates, ROSoClingoActionGoal, TaskPlan
from rosoclingo.reasoning.keywords import CORE
from rosoclingo.runs.account import Account, Summary

#: Topics of an account and their types, relative to the core's namespace.
TOPICS = {
    "out_rosoclingo": InterfaceIO,
    "in_rosoclingo": InterfaceIO,
    "rosoclingo/goal": ROSoClingoActionGoal,
    "rosoclingo/cancel": GoalID,
    "rosoclingo/status": GoalStatusArray,
    "rosoclingo/updates": String,
    "rosoclingo/task_plan": TaskPlan,
    "packages": PackageStates,
    "base_pose_ground_truth": Odometry,
}

#: Statuses of goals that have ended.
ENDS = ("succeeded", "canceled", "rejected", "aborted")

#: Those of them that the core publishes.
CORE_TOPICS = ("out_rosoclingo", "rosoclingo/status", "rosoclingo/updates", "rosoclingo/task_plan")


class TopicAccount:
    """An Account that takes ROS messages.

    ``labels`` names the robot's place when it is within ``tolerance`` metres of one.
    """

    def __init__(self, say: Callable[[str], None], labels: Optional[LabelTable] = None, tolerance: float = 0.5) -> None:
        self.account = Account(say)
        self._labels = labels
        self._tolerance = tolerance
        self._lock = threading.Lock()
        self._readers: Dict[str, Callable[[float, Any], None]] = {
            "out_rosoclingo": self._dispatched,
            "in_rosoclingo": lambda time, message: self.account.returned(time, message.interface, message.facts),
            "rosoclingo/goal": lambda time, message: self.account.goal(time, message.goal_id.id, message.goal.request),
            "rosoclingo/cancel": lambda time, message: self.account.cancel(time, message.id),
            "rosoclingo/status": self._statuses,
            "rosoclingo/updates": lambda time, message: self.account.update(time, message.data),
            "rosoclingo/task_plan": lambda time, message: self.account.plan(time, message.cycle, message.actions),
            "packages": self._packages,
            "base_pose_ground_truth": self._pose,
        }

    def take(self, topic: str, message: Any, time: float) -> None:
        """Enter a message of one of TOPICS; callable from any thread."""
        with self._lock:
            self._readers[topic](time, message)

    def ended(self, goals: int) -> bool:
        """Whether the account has heard of so many goals, and of the end of each."""
        with self._lock:
            heard = [one.status in ENDS for one in self.account.summary.goals]
            return len(heard) >= goals and all(heard)

    def finish(self) -> Summary:
        """End the account: print what was held back, and the summary."""
        with self._lock:
            self.account.finish()
            return self.account.summary

    def _dispatched(self, time: float, message: InterfaceIO) -> None:
        if message.interface != CORE:  # else the core tells of itself
            self.account.dispatched(time, message.facts)

    def _statuses(self, time: float, message: GoalStatusArray) -> None:
        for one in message.status_list:
            self.account.status(time, one.goal_id.id, one.status, one.text)

    def _packages(self, _time: float, message: PackageStates) -> None:
        self.account.packages((one.id, "carried" if one.carried else one.location) for one in message.packages)

    def _pose(self, _time: float, message: Odometry) -> None:
        if self._labels is not None:
            position = message.pose.pose.position
            label = self._labels.nearest(position.x, position.y, self._tolerance)
            self.account.robot("away from every label" if label is None else label.name)


class AccountNode(TopicAccount):
    """Prints the account of what happens from now on.

    Subscribes:
        out_rosoclingo, in_rosoclingo (rosoclingo/InterfaceIO), rosoclingo/task_plan (rosoclingo/TaskPlan)
        rosoclingo/goal (rosoclingo/ROSoClingoActionGoal), rosoclingo/cancel (actionlib_msgs/GoalID)
        rosoclingo/status (actionlib_msgs/GoalStatusArray), rosoclingo/updates (std_msgs/String)
        packages (rosoclingo/PackageStates), base_pose_ground_truth (nav_msgs/Odometry)
    """

    def __init__(self, say: Callable[[str], None], labels: Optional[LabelTable] = None) -> None:
        super().__init__(say, labels)
        self._subscribers = [
            rospy.Subscriber(topic, kind, self._on_message, callback_args=topic, queue_size=None)
            for topic, kind in TOPICS.items()
        ]

    @property
    def connected(self) -> bool:
        """Whether all that the core publishes comes to this node, and what others publish of the rest."""
        names = [one.name for one in self._subscribers]
        return all(comes_to(rospy.get_name(), one, none_will_do=not one.endswith(CORE_TOPICS)) for one in names)

    def _on_message(self, message: Any, topic: str) -> None:
        self.take(topic, message, rospy.get_time())
