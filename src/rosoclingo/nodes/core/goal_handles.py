"""The clients' side of the core's goals: actionlib's goal handles, kept until their goals end."""

from typing import Callable, Dict, List, Sequence, Tuple

import rospy
from actionlib import ServerGoalHandle

from rosoclingo.msg import ROSoClingoFeedback, ROSoClingoResult
from rosoclingo.reasoning import Action, GoalChanged, GoalEvent, GoalProgress, GoalRefused, Outcome

_ENDINGS: Dict[GoalEvent, Callable[[ServerGoalHandle, ROSoClingoResult, str], None]] = {
    GoalEvent.SUCCEED: ServerGoalHandle.set_succeeded,
    GoalEvent.CANCEL: ServerGoalHandle.set_canceled,
    GoalEvent.REJECT: ServerGoalHandle.set_rejected,
    GoalEvent.ABORT: ServerGoalHandle.set_aborted,
}


class GoalHandles:
    """Handles by goal id. Used by the worker only, as a handle takes the action server's lock."""

    def __init__(self) -> None:
        self._handles: Dict[str, ServerGoalHandle] = {}
        self._told: Tuple[Sequence[Action], List[str]] = ((), [])  # a plan, the same for all goals, and its text

    def add(self, key: str, handle: ServerGoalHandle) -> None:
        """Take a goal that arrived."""
        self._handles[key] = handle

    def changed(self, event: GoalChanged) -> None:
        """Tell the client of a transition; the one to a cancelling state the action server has made itself."""
        if event.event is GoalEvent.ACCEPT:
            self._handles[event.key].set_accepted(f"{event.term} is accepted")
        elif event.outcome is not None:
            self._end(event.key, event.event, event.outcome, event.message)

    def refused(self, event: GoalRefused) -> None:
        """Tell the client that its goal is not taken."""
        self._end(event.key, GoalEvent.REJECT, Outcome.REJECTED, event.message)

    def progress(self, event: GoalProgress) -> None:
        """Give the client feedback."""
        if event.actions is not self._told[0]:
            self._told = event.actions, [str(action.atom) for action in event.actions]
        status = f"waiting: {event.waits}" if event.waits else event.state.value
        feedback = ROSoClingoFeedback(event.cycle, self._told[1], event.position, status)
        self._handles[event.key].publish_feedback(feedback)

    def _end(self, key: str, ending: GoalEvent, outcome: Outcome, message: str) -> None:
        handle = self._handles.pop(key)
        _ENDINGS[ending](handle, ROSoClingoResult(int(outcome), message), message)
        rospy.loginfo("goal '%s' %s: %s", handle.get_goal().request, outcome.name.lower(), message)
