"""The goals of the core's clients: actionlib's handles, and the topic ``~goals`` for nodes that are no clients."""

import time
from collections import Counter
from typing import Any, Callable, Dict, List, Sequence, Tuple

import rospy
from actionlib import ServerGoalHandle
from actionlib_msgs.msg import GoalStatus

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.msg import GoalState as ShownGoal
from rosoclingo.msg import GoalStates, ROSoClingoFeedback, ROSoClingoResult
from rosoclingo.reasoning.events import GoalChanged, GoalProgress
from rosoclingo.reasoning.goals import GoalEvent, GoalState, Outcome
from rosoclingo.reasoning.keywords import Action, shortened

_ENDINGS: Dict[GoalEvent, Callable[[ServerGoalHandle, ROSoClingoResult, str], None]] = {
    GoalEvent.SUCCEED: ServerGoalHandle.set_succeeded,
    GoalEvent.CANCEL: ServerGoalHandle.set_canceled,
    GoalEvent.REJECT: ServerGoalHandle.set_rejected,
    GoalEvent.ABORT: ServerGoalHandle.set_aborted,
}

_ACCEPTED = (GoalState.ACTIVE, GoalState.PREEMPTING)
_OPEN = (GoalStatus.PENDING, GoalStatus.ACTIVE, GoalStatus.RECALLING, GoalStatus.PREEMPTING)
_BEGUN = (GoalStatus.ACTIVE, GoalStatus.PREEMPTING, GoalStatus.SUCCEEDED, GoalStatus.ABORTED, GoalStatus.PREEMPTED)

#: Limit of open goals of one node.
MOST_OPEN = 1000

#: Limit of ended goals that ``~goals`` repeats; the end of each goal is in one message at least.
ENDED = 100

#: Limit of characters of a goal's request and of its reason in ``~goals``; longer texts are shortened in the middle.
SHOWN = 500

#: Seconds of wall time within which changes are published together, as each message of ``~goals`` has all goals.
TOGETHER = 0.1


class GoalHandles:
    """The goals by their ids. Use them on the worker only, as a handle takes the action server's lock.

    ``missing`` returns a message if a running action has no interface, else an empty text.
    """

    def __init__(self, missing: Callable[[], str]) -> None:
        self._look_for_missing, self._missing = missing, ""
        self._handles: Dict[str, ServerGoalHandle] = {}
        self._progress: Dict[str, GoalProgress] = {}  # the latest of each open goal
        self._open: Dict[str, int] = Counter()  # by sending node
        self._plan: Tuple[Sequence[Action], List[str]] = ((), [])  # the latest plan, shared by all goals, and its text
        self._shown: Dict[str, ShownGoal] = {}  # in order of arrival; the messages are replaced, never changed
        self._changed, self._published = False, float("-inf")
        self._topic = prompt_publisher("~goals", GoalStates, 10, latch=True)
        self._publish()

    def has_room(self, handle: ServerGoalHandle) -> bool:
        """Return whether the goal's node is below its limit of open goals; else reject the goal."""
        if self._open[_node_of(handle)] < MOST_OPEN:
            return True
        text = f"{_node_of(handle)} has {MOST_OPEN} open goals: wait until some of them have ended"
        handle.set_rejected(ROSoClingoResult(ROSoClingoResult.REJECTED, text), text)
        return False

    def add(self, key: str, handle: ServerGoalHandle, has_ended: bool = False) -> None:
        """Add a goal that has arrived, or that had ended before a resume."""
        if not has_ended:
            self._handles[key] = handle
            self._open[_node_of(handle)] += 1
        self._shown.pop(key, None)
        request = shortened(handle.get_goal().request, SHOWN)
        self._shown[key] = ShownGoal(id=handle.get_goal_id(), request=request, came=rospy.Time.now())
        self._changed = True
        self._look(key, handle)

    def changed(self, event: GoalChanged) -> None:
        """Report a transition to the client, except to a cancelling state, which the action server reports itself."""
        if event.outcome is not None:
            self._end(event.key, event.event, event.outcome, event.message)
            return
        handle = self._handles[event.key]
        if event.event is GoalEvent.ACCEPT:
            handle.set_accepted(_accepted(handle))
        self._look(event.key, handle)

    def recall(self, key: str, message: str) -> None:
        """End a goal that was cancelled before the core received it."""
        self._end(key, GoalEvent.CANCEL, Outcome.CANCELED, message)

    def progress(self, event: GoalProgress) -> None:
        """Send feedback to the client, and put the program's remark about the goal into its status."""
        self._progress[event.key] = event
        if event.actions is not self._plan[0]:
            self._plan = event.actions, [str(action.atom) for action in event.actions]
            self._missing = self._look_for_missing()
        state, waits = event.state.value, event.waits or self._missing
        status = f"waiting: {waits}" if waits else f"{state}: {event.remark}" if event.remark else state
        feedback = ROSoClingoFeedback(event.cycle, self._plan[1], event.position, status)
        handle = self._handles[event.key]
        handle.publish_feedback(feedback)
        if not event.waits and event.state in _ACCEPTED:
            _set_remark(handle, event.remark)
        self._look(event.key, handle)

    def tick(self) -> None:
        """Publish changes, at most every TOGETHER seconds; send feedback again if an interface has appeared or gone."""
        if time.monotonic() - self._published >= TOGETHER:
            self.flush()
        before, self._missing = self._missing, self._look_for_missing()
        if self._missing != before:
            for event in [one for one in self._progress.values() if not one.waits]:
                self.progress(event)

    def flush(self) -> None:
        """Publish changes immediately."""
        if self._changed:
            self._publish()

    def _publish(self) -> None:
        self._changed, self._published = False, time.monotonic()
        message = GoalStates(goals=list(self._shown.values()))
        message.header.stamp = rospy.Time.now()
        self._topic.publish(message)
        ended = [key for key, goal in self._shown.items() if goal.status not in _OPEN]
        for key in ended[:-ENDED]:
            del self._shown[key]

    def _look(self, key: str, handle: ServerGoalHandle) -> None:
        """Update a goal for ``~goals`` from actionlib's server, and from the reason why it is queued, if any."""
        before, found, progress = self._shown[key], handle.get_goal_status(), self._progress.get(key)
        status, now, waits = found.status, rospy.Time.now(), "" if progress is None else progress.waits
        self._shown[key] = ShownGoal(
            id=before.id,
            request=before.request,
            status=status,
            reason=shortened(waits or found.text, SHOWN),
            came=before.came,
            since=before.since or (now if status in _BEGUN else rospy.Time()),
            ended=now if status not in _OPEN else rospy.Time(),
        )
        self._changed |= self._shown[key] != before

    def _end(self, key: str, ending: GoalEvent, outcome: Outcome, message: str) -> None:
        handle = self._handles.pop(key)
        self._progress.pop(key, None)
        self._open[_node_of(handle)] -= 1
        _ENDINGS[ending](handle, ROSoClingoResult(int(outcome), message), message)
        self._look(key, handle)
        request, why = shortened(handle.get_goal().request), shortened(message, SHOWN)
        rospy.loginfo("goal '%s' %s: %s", request, outcome.name.lower(), why)


def _set_remark(handle: ServerGoalHandle, remark: str) -> None:
    """Set a new remark as the text of an accepted goal's status; actionlib has no function for this."""
    text = f"{_accepted(handle)}: {remark}" if remark else _accepted(handle)
    if text != handle.get_goal_status().text:
        with handle.action_server.lock:
            handle.status_tracker.status.text = text
            handle.action_server.publish_status()


def _accepted(handle: ServerGoalHandle) -> str:
    return f"{shortened(handle.get_goal().request)} is accepted"


def _node_of(handle: Any) -> str:
    """Return the node that has sent a goal; empty for a restored goal."""
    header = getattr(handle.goal, "_connection_header", None) or {}
    return str(header.get("callerid", ""))


def stamp_of(handle: Any) -> Tuple[int, int]:
    """Return the time at which a goal was sent, in seconds and nanoseconds."""
    stamp = handle.get_goal_id().stamp
    return stamp.secs, stamp.nsecs
