"""Actionlib's handles of the core's open goals, through which clients get their status."""

import time
from collections import Counter
from typing import Any, Callable, Dict, List, Sequence, Tuple

import rospy
from actionlib import ServerGoalHandle
from actionlib_msgs.msg import GoalStatus

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.msg import ROSoClingoActionResult, ROSoClingoFeedback, ROSoClingoResult
from rosoclingo.nodes.core.board import SHOWN, GoalBoard
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

#: Seconds of wall time during which a resumed core sends results to each client that connects.
RESENT = 60.0

#: Limit of open goals of one node.
MOST_OPEN = 1000


class GoalHandles:
    """Handles by goal id. Use them on the worker only, as a handle takes the action server's lock.

    ``missing`` returns a message if a running action has no interface, else an empty text.

    Attributes:
        board: the states of the goals, for the topic ``~goals``.

    """

    def __init__(self, missing: Callable[[], str]) -> None:
        self._look_for_missing, self._missing = missing, ""
        self._handles: Dict[str, ServerGoalHandle] = {}
        self._progress: Dict[str, GoalProgress] = {}  # the latest of each open goal
        self._open: Dict[str, int] = Counter()  # by sending node
        self.board = GoalBoard()
        self._plan: Tuple[Sequence[Action], List[str]] = ((), [])  # the latest plan, shared by all goals, and its text

    def has_room(self, handle: ServerGoalHandle) -> bool:
        """Return whether the goal's node is below its limit of open goals; else reject the goal."""
        if self._open[_node_of(handle)] < MOST_OPEN:
            return True
        text = f"{_node_of(handle)} has {MOST_OPEN} open goals: wait until some of them have ended"
        handle.set_rejected(ROSoClingoResult(ROSoClingoResult.REJECTED, text), text)
        return False

    def add(self, key: str, handle: ServerGoalHandle) -> None:
        """Add a goal that has arrived."""
        self._handles[key] = handle
        self._open[_node_of(handle)] += 1
        self.board.add(key, handle)

    def changed(self, event: GoalChanged) -> None:
        """Report a transition to the client, except to a cancelling state, which the action server reports itself."""
        if event.outcome is not None:
            self._end(event.key, event.event, event.outcome, event.message)
            return
        handle = self._handles[event.key]
        if event.event is GoalEvent.ACCEPT:
            handle.set_accepted(_accepted(handle))
        self._look(event.key)

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
        self._look(event.key)

    def tick(self) -> None:
        """Publish changes; send feedback again if an interface has appeared or has gone."""
        self.board.tick()
        before, self._missing = self._missing, self._look_for_missing()
        if self._missing != before:
            for event in [one for one in self._progress.values() if not one.waits]:
                self.progress(event)

    def _look(self, key: str) -> None:
        """Update the state of an open goal for ``~goals``."""
        progress = self._progress.get(key)
        self.board.look(key, self._handles[key], "" if progress is None else progress.waits)

    def _end(self, key: str, ending: GoalEvent, outcome: Outcome, message: str) -> None:
        handle = self._handles.pop(key)
        self._progress.pop(key, None)
        self._open[_node_of(handle)] -= 1
        _ENDINGS[ending](handle, ROSoClingoResult(int(outcome), message), message)
        self.board.look(key, handle)
        request, why = shortened(handle.get_goal().request), shortened(message, SHOWN)
        rospy.loginfo("goal '%s' %s: %s", request, outcome.name.lower(), why)


class Results:
    """Results that a resumed core sends to each client that connects, since clients reconnect one by one.

    They belong to goals that ended before the core was killed, or before all clients had reconnected.
    """

    def __init__(self, resumed: bool) -> None:
        self._messages: List[ROSoClingoActionResult] = []
        self._until = time.monotonic() + (RESENT if resumed else 0.0)

    def open(self, name: str) -> None:
        """Let clients of the action server ``name`` connect; call this after adding all earlier results."""
        topic = rospy.remap_name(name) + "/result"
        prompt_publisher(topic, ROSoClingoActionResult, queue_size=1000, greeting=lambda: list(self._messages))

    @property
    def awaited(self) -> bool:
        """Whether clients can still be reconnecting."""
        return time.monotonic() < self._until

    def add(self, status: GoalStatus, result: ROSoClingoResult) -> None:
        """Add a result before it is published, so that a client that connects meanwhile gets it twice, not never."""
        self._messages.append(ROSoClingoActionResult(status=status, result=result))

    def expired(self) -> List[str]:
        """Return and forget the keys of goals whose results need not be sent any more."""
        if not self._messages or self.awaited:
            return []
        messages, self._messages = self._messages, []
        return [one.status.goal_id.id for one in messages]


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
