"""The action server of the core, which reports goals to clients once they are in the journal."""

import time
from collections import deque
from functools import partial
from typing import Any, Callable, Deque, List, NamedTuple

import rospy
from actionlib import ActionServer, ServerGoalHandle
from actionlib.handle_tracker_deleter import HandleTrackerDeleter
from actionlib.status_tracker import StatusTracker
from actionlib_msgs.msg import GoalID, GoalStatus

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.msg import ROSoClingoAction, ROSoClingoActionGoal, ROSoClingoActionResult, ROSoClingoResult
from rosoclingo.nodes.core.sender_limit import SenderLimit

#: Limit of one node's queued goals and cancels.
MOST_ARRIVALS = 100

#: Limit of characters of a goal's id, which each status message repeats.
LONGEST_ID = 1000

#: Limit of goals and cancels that the worker takes together.
TURN = 100

#: Seconds of wall time during which a resumed core sends results to each client that connects.
RESENT = 60.0

Taker = Callable[[ServerGoalHandle], None]

#: The outcome of each terminal status, and its default text.
_ENDS = {
    GoalStatus.SUCCEEDED: (ROSoClingoResult.SUCCEEDED, "the goal is met"),
    GoalStatus.PREEMPTED: (ROSoClingoResult.CANCELED, "the goal was cancelled"),
    GoalStatus.RECALLED: (ROSoClingoResult.CANCELED, "the goal was cancelled before it arrived"),
    GoalStatus.REJECTED: (ROSoClingoResult.REJECTED, "the goal was rejected"),
    GoalStatus.ABORTED: (ROSoClingoResult.ABORTED, "the goal was aborted"),
}


class _Arrival(NamedTuple):
    """A queued goal or cancel, and actionlib's function that processes it."""

    node: str
    take: Callable[[], None]
    is_goal: bool


class GoalServer(ActionServer):  # type: ignore[misc]
    """actionlib's server, with a queue of goals and cancels for the worker.

    The server publishes no status while a goal is queued: a client that has cancelled its goal counts the goal as lost
    if a status lacks it. ``arrived`` is called on rospy's threads, and has to make the worker call :meth:`take`.
    The connection of a node with MOST_ARRIVALS queued arrivals is not read, so TCP slows the node down, and nothing is
    lost. Clients reconnect one by one to a server that has ``resumed``: each one gets the results of goals that ended
    before.
    """

    def __init__(
        self, name: str, on_goal: Taker, on_cancel: Taker, arrived: Callable[[], None], resumed: bool = False
    ) -> None:
        super().__init__(name, ROSoClingoAction, on_goal, on_cancel, auto_start=False)
        self._arrived = arrived
        self._results: List[ROSoClingoActionResult] = []  # for clients that connect later
        self._clients_until = time.monotonic() + (RESENT if resumed else 0.0)
        self._deferred = False  # whether a status has to be published once the queue is empty
        self._published = False  # whether the status of the present result is already published
        self._arrivals: Deque[_Arrival] = deque()
        self._limit = SenderLimit(MOST_ARRIVALS)
        self._taking = False  # whether taken arrivals are not in the journal yet

    @property
    def arrivals(self) -> int:
        """The number of queued goals and cancels."""
        return len(self._arrivals)

    def internal_goal_callback(self, goal: Any) -> None:
        """Queue a goal; called by rospy."""
        self._put(goal, goal.goal_id.id, partial(super().internal_goal_callback, goal), is_goal=True)

    def internal_cancel_callback(self, goal_id: Any) -> None:
        """Queue a cancel; called by rospy."""
        self._put(goal_id, goal_id.id, partial(super().internal_cancel_callback, goal_id), is_goal=False)

    def _put(self, message: Any, key: str, take: Callable[[], None], is_goal: bool) -> None:
        """Queue an arrival, once its node is below its limit."""
        node = str(message._connection_header["callerid"])
        if len(key) > LONGEST_ID:
            text = "dropped a goal or cancel of %s: its id has more than %d characters"
            rospy.logwarn_throttle(10.0, text, node, LONGEST_ID)
        elif self._limit.enter(node):
            self._arrivals.append(_Arrival(node, take, is_goal))
            self._arrived()

    def take(self, keep: Callable[[], None]) -> None:
        """Process queued arrivals, and publish them after ``keep``; called by the worker."""
        self._taking = True
        turn = min(TURN, len(self._arrivals))
        for _ in range(turn):
            one = self._arrivals.popleft()
            self._limit.leave(one.node)
            one.take()
        if turn:
            keep()
        self._taking = False
        if self._deferred:
            self.publish_status()

    def publish_status(self) -> None:
        """Publish the status unless goals are queued; called by actionlib on each change and by its timer."""
        with self.lock:
            if self._published:
                return
            # in this order, as the worker sets _taking before it takes a goal from the queue; the list is a copy at one
            # moment, because rospy's threads add arrivals meanwhile
            self._deferred = any(one.is_goal for one in list(self._arrivals)) or self._taking
            if not self._deferred:
                super().publish_status()

    def publish_result(self, status: GoalStatus, result: Any) -> None:
        """Publish a result with the outcome and the text of its status; called by actionlib.

        The status is published first, so that a client that sends its next goal on this result gets no older status.
        """
        result.outcome, words = _ENDS[status.status]
        result.message = result.message or status.text or words
        status.text = status.text or result.message
        with self.lock:
            self.keep_result(status, result)
            self.publish_status()
            self._published = True
            try:
                super().publish_result(status, result)
            finally:
                self._published = False

    def keep_result(self, status: GoalStatus, result: ROSoClingoResult) -> None:
        """Keep a result, before it is published, so that a client that connects meanwhile gets it twice, not never."""
        self._results.append(ROSoClingoActionResult(status=status, result=result))

    def greet(self) -> None:
        """Send the kept results to each client that connects; call this before the server starts."""
        topic = rospy.remap_name(self.ns) + "/result"
        prompt_publisher(topic, ROSoClingoActionResult, queue_size=1000, greeting=lambda: list(self._results))

    @property
    def awaits_clients(self) -> bool:
        """Whether clients can still be reconnecting after a resume."""
        return time.monotonic() < self._clients_until

    def drop_results(self) -> List[str]:
        """Drop the results that need not be sent any more, and return the keys of their goals."""
        if not self._results or self.awaits_clients:
            return []
        results, self._results = self._results, []
        return [one.status.goal_id.id for one in results]

    def restore(self, key: str, text: str, stamp: rospy.Time, status: int, reason: str = "") -> ServerGoalHandle:
        """Restore a goal of a previous process, for the first status message; call this before the server starts."""
        goal = ROSoClingoActionGoal(goal_id=GoalID(id=key, stamp=stamp))
        goal.goal.request = text
        tracker = StatusTracker(None, None, goal)
        tracker.status = GoalStatus(goal_id=goal.goal_id, status=status, text=reason)
        tracker.handle_tracker = HandleTrackerDeleter(self, tracker)
        self.status_list.append(tracker)
        return ServerGoalHandle(tracker, self, tracker.handle_tracker)
