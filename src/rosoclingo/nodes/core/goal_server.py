"""The action server of the core: clients hear of what arrived, and of what was, once it is in the journal."""

from collections import deque
from typing import Any, Callable, Deque

import rospy
from actionlib import ActionServer, ServerGoalHandle
from actionlib.handle_tracker_deleter import HandleTrackerDeleter
from actionlib.status_tracker import StatusTracker
from actionlib_msgs.msg import GoalID, GoalStatus

from rosoclingo.msg import ROSoClingoAction, ROSoClingoActionGoal

Taker = Callable[[ServerGoalHandle], None]


class GoalServer(ActionServer):  # type: ignore[misc]
    """actionlib's server, in which goals and cancels wait until the worker takes them.

    Until then no status tells of them: ``arrived`` is called from rospy's threads and is to have the worker call
    :meth:`take`. ``ending`` is called with each result before it goes out.
    """

    def __init__(
        self, name: str, on_goal: Taker, on_cancel: Taker, arrived: Callable[[], None], ending: Callable[..., None]
    ) -> None:
        super().__init__(name, ROSoClingoAction, on_goal, on_cancel, auto_start=False)
        self._arrived, self._ending = arrived, ending
        self._arrivals: Deque[Callable[[], None]] = deque()

    @property
    def has_arrivals(self) -> bool:
        """Whether anything waits to be taken."""
        return bool(self._arrivals)

    def internal_goal_callback(self, goal: Any) -> None:
        """Called by rospy."""
        take = super().internal_goal_callback
        self._arrivals.append(lambda: take(goal))
        self._arrived()

    def internal_cancel_callback(self, goal_id: Any) -> None:
        """Called by rospy."""
        take = super().internal_cancel_callback
        self._arrivals.append(lambda: take(goal_id))
        self._arrived()

    def publish_result(self, status: GoalStatus, result: Any) -> None:
        """Called by actionlib's goal handles."""
        self._ending(status, result)
        super().publish_result(status, result)

    def take(self, keep: Callable[[], None]) -> None:
        """Take what has arrived; called by the worker. It is shown to clients after ``keep``."""
        with self.lock:
            taken = False
            while self._arrivals:
                self._arrivals.popleft()()
                taken = True
            if taken:
                keep()

    def restore(self, key: str, text: str, stamp: rospy.Time, status: int, message: str = "") -> ServerGoalHandle:
        """Have a goal of before in the first status message; to be called before the server starts."""
        goal = ROSoClingoActionGoal(goal_id=GoalID(id=key, stamp=stamp))
        goal.goal.request = text
        tracker = StatusTracker(None, None, goal)
        tracker.status = GoalStatus(goal_id=goal.goal_id, status=status, text=message)
        tracker.handle_tracker = HandleTrackerDeleter(self, tracker)
        self.status_list.append(tracker)
        return ServerGoalHandle(tracker, self, tracker.handle_tracker)
