"""The account of a live run, from public topics."""

import threading
from typing import Any, Callable, Collection, List, Mapping, Optional

import rospy

from rosoclingo.common.connections import is_delivered_to
from rosoclingo.nodes.run_topics import PATHS, RunTopics
from rosoclingo.nodes.topic_types import TYPES
from rosoclingo.runs.account import Account, Summary
from rosoclingo.runs.sentences import Sentences
from rosoclingo.runs.topic_names import USUAL, full_name

#: The topics of an account, with names for :func:`full_name`, and their types.
TOPICS = {
    name: kind
    for name, kind in TYPES.items()
    if name not in ("rosoclingo/feedback", "rosoclingo/result", "map", "/rosout", *PATHS)
}

#: Statuses of goals that have ended.
ENDS = ("succeeded", "canceled", "rejected", "aborted")

#: The topics of TOPICS that the core publishes.
CORE_TOPICS = ("out_rosoclingo", "rosoclingo/status", "~updates", "~task_plan")


class TopicAccount:
    """An Account with ROS messages as its input; ``with_state`` adds the program's beliefs."""

    def __init__(self, say: Callable[[str], None], with_state: bool = False) -> None:
        self.account = Account(say, with_state=with_state)
        self._topics = RunTopics(self.account)
        self._lock = threading.Lock()

    def take(self, topic: str, message: Any, time: float) -> None:
        """Process a message of one of TOPICS; callable from any thread."""
        with self._lock:
            if not self._topics.is_too_soon(topic, time):
                self._topics.takes[topic](time, message)

    def tick(self, time: float) -> None:
        """Print the lines that are due at this time; callable from any thread."""
        with self._lock:
            self.account.clock(time)

    def ended(self, keys: Collection[str]) -> bool:
        """Return whether the goals with these keys have ended in the account."""
        with self._lock:
            return {one.key for one in self.account.summary.goals if one.status in ENDS}.issuperset(keys)

    def differences(
        self, expect: Mapping[str, Any], before: int = 0, sent: Optional[Collection[str]] = None
    ) -> List[str]:
        """Return the differences from a scenario's ``expect``, see :meth:`Summary.differences`."""
        with self._lock:
            return self.account.summary.differences(expect, before, sent)

    def finish(self) -> Summary:
        """End the account: print delayed lines, and return the summary."""
        with self._lock:
            self.account.finish()
            return self.account.summary


class AccountNode(TopicAccount):
    """Prints the account of a core from now on; ``words`` are the sentences of its program.

    Subscribes:
        CORE/program, CORE/mode (std_msgs/String), CORE/goals (rosoclingo/GoalStates), CORE/state (rosoclingo/State)
        out_rosoclingo, in_rosoclingo (rosoclingo/InterfaceIO), CORE/task_plan (rosoclingo/TaskPlan)
        rosoclingo/goal (rosoclingo/ROSoClingoActionGoal), rosoclingo/cancel (actionlib_msgs/GoalID)
        rosoclingo/status (actionlib_msgs/GoalStatusArray), CORE/updates (std_msgs/String)
        packages (rosoclingo/PackageStates), base_pose_ground_truth (nav_msgs/Odometry)
        amcl_pose (geometry_msgs/PoseWithCovarianceStamped), /tf, /tf_static (tf2_msgs/TFMessage)
    """

    def __init__(
        self,
        say: Callable[[str], None],
        with_state: bool = False,
        core: str = USUAL,
        words: Optional[Sentences] = None,
    ) -> None:
        super().__init__(say, with_state)
        if words is not None:
            self.account.sentences = words  # before the first message can arrive
        self._subscribers = {
            topic: rospy.Subscriber(
                full_name(topic, core), kind, self._on_message, callback_args=topic, queue_size=None
            )
            for topic, kind in TOPICS.items()
        }

    @property
    def connected(self) -> bool:
        """Whether all messages of the core and of other publishers arrive at this node."""
        found = self._subscribers.items()
        me = rospy.get_name()
        return all(is_delivered_to(me, one.name, allow_none=topic not in CORE_TOPICS) for topic, one in found)

    def _on_message(self, message: Any, topic: str) -> None:
        self.take(topic, message, rospy.get_time())
