"""A client of the core's action server, for any number of goals."""

import threading
import time
from typing import Callable, List, Optional

import rospy
from actionlib import ActionClient, ClientGoalHandle, CommState
from actionlib_msgs.msg import GoalStatus

from rosoclingo.msg import ROSoClingoAction, ROSoClingoFeedback, ROSoClingoGoal

#: actionlib's terminal states as the words of a goal's outcome.
OUTCOME_WORDS = {
    GoalStatus.SUCCEEDED: "succeeded",
    GoalStatus.PREEMPTED: "canceled",
    GoalStatus.RECALLED: "canceled",
    GoalStatus.REJECTED: "rejected",
    GoalStatus.ABORTED: "aborted",
    GoalStatus.LOST: "lost",
}

_CANCELLABLE = (CommState.PENDING, CommState.ACTIVE)


class SentGoal:
    """One goal on its way: ``outcome`` is a word of OUTCOME_WORDS and ``message`` the reason, once it has ended."""

    def __init__(self, text: str, on_change: Callable[[], None]) -> None:
        self.text = text
        self.outcome = ""
        self.message = ""
        self.feedback: Optional[ROSoClingoFeedback] = None
        self._on_change = on_change
        self._handle: Optional[ClientGoalHandle] = None
        self._unwanted = False

    @property
    def ended(self) -> bool:
        """Whether the server has ended it."""
        return bool(self.outcome)

    def send(self, client: ActionClient) -> None:
        """Send it; once only."""
        self._handle = client.send_goal(ROSoClingoGoal(self.text), self._on_transition, self._on_feedback)

    def cancel(self) -> None:
        """Ask the server to cancel it, once it has acknowledged it; it ends when the server says so.

        actionlib's client takes a goal that was cancelled before it was acknowledged for lost.
        """
        self._unwanted = True
        self._cancel_if_unwanted()

    def _cancel_if_unwanted(self) -> None:
        if self._unwanted and self._handle is not None and self._handle.get_comm_state() in _CANCELLABLE:
            self._handle.cancel()

    def _on_transition(self, handle: ClientGoalHandle) -> None:
        if handle.get_comm_state() == CommState.DONE:
            result = handle.get_result()
            self.message = result.message if result is not None and result.message else handle.get_goal_status_text()
            self.outcome = OUTCOME_WORDS[handle.get_terminal_state()]
            self._on_change()
        else:
            self._cancel_if_unwanted()

    def _on_feedback(self, _handle: ClientGoalHandle, feedback: ROSoClingoFeedback) -> None:
        self.feedback = feedback
        self._on_change()


class CoreClient:
    """Sends goals to the core under the name ``server`` and lets the caller wait for what comes of them."""

    def __init__(self, server: str = "rosoclingo") -> None:
        self._client = ActionClient(server, ROSoClingoAction)
        self._news = threading.Condition()
        self.goals: List[SentGoal] = []

    def wait_for_server(self, timeout: float) -> bool:
        """Wait until goals will arrive, at most ``timeout`` seconds of wall time; whether they will."""
        end = time.monotonic() + timeout
        while time.monotonic() < end and not rospy.is_shutdown():
            # actionlib measures its time-out by ROS time, which may stand still or not have begun: so in short turns
            if self._client.last_status_msg is not None and self._client.wait_for_server(rospy.Duration(0.001)):
                return True
            self.wait(0.02)
        return False

    def send(self, text: str) -> SentGoal:
        """Send a goal."""
        goal = SentGoal(text, self._notify)
        self.goals.append(goal)
        goal.send(self._client)
        return goal

    def wait(self, timeout: float) -> None:
        """Wait for news of any goal, at most ``timeout`` seconds of wall time."""
        with self._news:
            self._news.wait(timeout)

    def _notify(self) -> None:
        with self._news:
            self._news.notify_all()
