"""The account of a live run, from public topics."""

from contextlib import suppress
from queue import Empty, Queue
from typing import Any, Tuple

import rospy
from genpy.message import get_message_class

from rosoclingo.common.connections import is_delivered_to
from rosoclingo.nodes.run_topics import PATHS, TYPES, RunTopics
from rosoclingo.runs.account import Account
from rosoclingo.runs.topic_names import USUAL, full_name

#: The topics of an account, with names for :func:`full_name`, and their types.
TOPICS = {name: kind for name, kind in TYPES.items() if name not in ("map", "/rosout", *PATHS)}

#: The topics of TOPICS that the core publishes.
CORE_TOPICS = ("out_rosoclingo", "~goals", "~updates", "~task_plan")


class AccountNode:
    """Continues the ``account`` of a core's run from now on.

    Messages are handled, and lines printed, by the thread that calls the methods; call :meth:`tick` often.

    Subscribes:
        CORE/program, CORE/mode (std_msgs/String), CORE/goals (rosoclingo/GoalStates), CORE/state (rosoclingo/State)
        out_rosoclingo, in_rosoclingo (rosoclingo/InterfaceIO), CORE/task_plan (rosoclingo/TaskPlan)
        rosoclingo/cancel (actionlib_msgs/GoalID), CORE/updates (std_msgs/String)
        packages (rosoclingo/PackageStates), base_pose_ground_truth (nav_msgs/Odometry)
        amcl_pose (geometry_msgs/PoseWithCovarianceStamped), /tf, /tf_static (tf2_msgs/TFMessage)

    """

    def __init__(self, account: Account, core: str = USUAL) -> None:
        self._account = account
        self._topics = RunTopics(account)
        # not SimpleQueue: a signal handler that takes longer than the time-out of its get() makes it wait for ever
        self._arrived: Queue[Tuple[float, str, Any]] = Queue()
        self._subscribers = {
            topic: rospy.Subscriber(
                full_name(topic, core), get_message_class(kind), self._on_message, callback_args=topic, queue_size=None
            )
            for topic, kind in TOPICS.items()
        }

    @property
    def connected(self) -> bool:
        """Whether all messages of the core and of other publishers arrive at this node."""
        found = self._subscribers.items()
        me = rospy.get_name()
        return all(is_delivered_to(me, one.name, allow_none=topic not in CORE_TOPICS) for topic, one in found)

    def tick(self, wait: float = 0.0) -> None:
        """Print the lines that are due now; wait at most ``wait`` seconds of wall time for a message."""
        with suppress(Empty):
            self._take(*self._arrived.get(timeout=wait))
            while True:
                self._take(*self._arrived.get_nowait())
        self._account.clock(rospy.get_time())

    def finish(self) -> None:
        """End the account: print delayed lines."""
        self.tick()
        self._account.finish()

    def _on_message(self, message: Any, topic: str) -> None:
        self._arrived.put((rospy.get_time(), topic, message))

    def _take(self, time: float, topic: str, message: Any) -> None:
        if not self._topics.is_too_soon(topic, time):
            self._topics.pass_on(topic, time, message)
