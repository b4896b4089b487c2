"""The topic ``~goals``: the states of all goals, for nodes that are not actionlib clients."""

import time
from typing import Dict

import rospy
from actionlib import ServerGoalHandle
from actionlib_msgs.msg import GoalStatus

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.msg import GoalState, GoalStates
from rosoclingo.reasoning.keywords import shortened

#: Limit of ended goals that are published again; the end of each goal is in one message at least.
ENDED = 100

#: Limit of characters of a goal's request and of its reason; longer texts are shortened in the middle.
SHOWN = 500

#: Seconds of wall time within which changes are published together, as each message has all goals.
TOGETHER = 0.1

_OPEN = (GoalStatus.PENDING, GoalStatus.ACTIVE, GoalStatus.RECALLING, GoalStatus.PREEMPTING)
_ACCEPTED = (GoalStatus.ACTIVE, GoalStatus.PREEMPTING, GoalStatus.SUCCEEDED, GoalStatus.ABORTED, GoalStatus.PREEMPTED)


class GoalBoard:
    """The goals in order of arrival. Use it on the worker only, as a handle takes the action server's lock."""

    def __init__(self) -> None:
        self._goals: Dict[str, GoalState] = {}  # in order of arrival; its messages are replaced, never changed
        self._changed = False
        self._last = float("-inf")
        self._topic = prompt_publisher("~goals", GoalStates, 10, latch=True)
        self._publish()

    def add(self, key: str, handle: ServerGoalHandle) -> None:
        """Add a goal that has arrived."""
        self._goals.pop(key, None)
        request = shortened(handle.get_goal().request, SHOWN)
        self._goals[key] = GoalState(id=handle.get_goal_id(), request=request, came=rospy.Time.now())
        self._changed = True
        self.look(key, handle)

    def look(self, key: str, handle: ServerGoalHandle, waits: str = "") -> None:
        """Update a goal's status from actionlib's server; ``waits`` is the reason why it is queued, if any."""
        before, found = self._goals[key], handle.get_goal_status()
        status, now = found.status, rospy.Time.now()
        accepted, ended = status in _ACCEPTED, status not in _OPEN
        self._goals[key] = GoalState(
            id=before.id,
            request=before.request,
            status=status,
            reason=shortened(waits or found.text, SHOWN),
            came=before.came,
            since=before.since or (now if accepted else rospy.Time()),
            ended=now if ended else rospy.Time(),
        )
        self._changed |= self._goals[key] != before

    def tick(self) -> None:
        """Publish changes, at most every TOGETHER seconds; call this often."""
        if self._changed and time.monotonic() - self._last >= TOGETHER:
            self._publish()

    def flush(self) -> None:
        """Publish changes immediately."""
        if self._changed:
            self._publish()

    def _publish(self) -> None:
        self._changed, self._last = False, time.monotonic()
        message = GoalStates(goals=list(self._goals.values()))
        message.header.stamp = rospy.Time.now()
        self._topic.publish(message)
        ended = [key for key, goal in self._goals.items() if goal.status not in _OPEN]
        for key in ended[:-ENDED]:
            del self._goals[key]
