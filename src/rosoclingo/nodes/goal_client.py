"""A client of the core's action server, for any number of goals."""

import threading
import time
from typing import Any, Callable, List, Optional

import rospy
from actionlib import ActionClient, ClientGoalHandle, CommState
from actionlib_msgs.msg import GoalStatus

from rosoclingo.common.action_clients import cancel_goal, goal_id
from rosoclingo.common.connections import is_delivered_to
from rosoclingo.msg import ROSoClingoAction, ROSoClingoFeedback, ROSoClingoGoal
from rosoclingo.nodes.server_watch import SILENCE, ServerWatch
from rosoclingo.runs.events import STATUS_WORDS


class SentGoal:
    """A goal of this client; after its end ``outcome`` is a word of STATUS_WORDS and ``message`` the reason."""

    def __init__(self, text: str, client: ActionClient, on_change: Callable[[], None]) -> None:
        """Create a goal; call ``send`` to send it."""
        self.text = text
        self.outcome = ""
        self.message = ""
        self.feedback: Optional[ROSoClingoFeedback] = None
        self.heard = time.monotonic()  # time of the last news of the goal, or of its sending
        self._client = client
        self._on_change = on_change
        self._handle: Optional[ClientGoalHandle] = None
        self._unwanted = False

    @property
    def ended(self) -> bool:
        """Whether the goal has ended."""
        return bool(self.outcome)

    @property
    def identifier(self) -> str:
        """Actionlib's id of the goal, empty before the goal was sent."""
        return goal_id(self._handle) if self._handle is not None else ""

    def send(self) -> None:
        """Send the goal; call this once."""
        self._handle = self._client.send_goal(ROSoClingoGoal(self.text), self._on_transition, self._on_feedback)

    @property
    def acknowledged(self) -> bool:
        """Whether the server has reported the goal."""
        return self._handle is not None and self._handle.get_comm_state() != CommState.WAITING_FOR_GOAL_ACK

    def send_again(self) -> None:
        """Resend an unacknowledged goal and its cancel: rospy can drop both, and the server accepts an id only once."""
        if self._handle is not None and not self.acknowledged:
            self._client.pub_goal.publish(self._handle.comm_state_machine.action_goal)
            if self._unwanted:
                self.cancel()

    def cancel(self) -> None:
        """Ask the server to cancel the goal, acknowledged or not; the goal ends when the server ends it."""
        self._unwanted = True
        if self._handle is not None:
            cancel_goal(self._client, self._handle)

    def lose(self, why: str) -> None:
        """End the goal as lost."""
        self._end(STATUS_WORDS[GoalStatus.LOST], why)

    def _on_transition(self, handle: ClientGoalHandle) -> None:
        if handle.get_comm_state() == CommState.DONE:
            result = handle.get_result()
            status = handle.get_terminal_state()
            message = result.message if result is not None and result.message else handle.get_goal_status_text()
            lost = status == GoalStatus.LOST
            self._end(STATUS_WORDS[status], f"the server no longer knows {self.text}" if lost else message)

    def _end(self, outcome: str, message: str) -> None:
        if not self.ended:
            self.message, self.outcome = message, outcome
            self._on_change()

    def _on_feedback(self, _handle: ClientGoalHandle, feedback: ROSoClingoFeedback) -> None:
        self.feedback, self.heard = feedback, time.monotonic()
        self._on_change()


class CoreClient:
    """Sends goals to the core's action server, and waits for news of them."""

    def __init__(self, server: str = "rosoclingo") -> None:
        self._client = ActionClient(server, ROSoClingoAction)
        self._news = threading.Condition()
        self._watch: Optional[ServerWatch] = None
        self._latest: Any = None  # status message
        self.goals: List[SentGoal] = []

    def wait_for_server(self, timeout: float) -> bool:
        """Wait until client and server are connected, at most ``timeout`` s of wall time; return whether they are."""
        end = time.monotonic() + timeout
        while time.monotonic() < end and not rospy.is_shutdown():
            # actionlib's wait_for_server has its time-out in ROS time, which can stand still or not have begun
            status = self._client.last_status_msg
            server = "" if status is None else status._connection_header["callerid"]
            if server and self._is_heard(server) and self._hears(server):
                self._watch = ServerWatch(server)
                return True
            self.wait(0.02)
        return False

    def _is_heard(self, server: str) -> bool:
        return all(one.impl.has_connection(server) for one in (self._client.pub_goal, self._client.pub_cancel))

    def _hears(self, server: str) -> bool:
        subscribers = (self._client.feedback_sub, self._client.result_sub)
        return all(is_delivered_to(rospy.get_name(), one.resolved_name, [server]) for one in subscribers)

    @property
    def node(self) -> str:
        """The name of the server's node, empty before ``wait_for_server``."""
        return "" if self._watch is None else self._watch.node

    def send(self, text: str) -> SentGoal:
        """Send a goal."""
        goal = SentGoal(text, self._client, self._notify)
        self.goals.append(goal)
        goal.send()
        return goal

    def check(self) -> None:
        """End lost goals; call this while waiting for goals.

        A goal without news for SILENCE seconds of wall time is lost if the server does not respond, was restarted,
        or no longer reports the acknowledged goal. This takes some seconds if the server does not respond.
        """
        before, self._latest = self._latest, self._client.last_status_msg
        known = {one.goal_id.id for one in self._latest.status_list} if self._latest is not None else set()
        for goal in [one for one in self.goals if not one.ended]:
            reported = goal.identifier in known
            if reported and self._latest is not before:
                goal.heard = time.monotonic()
            if time.monotonic() - goal.heard < SILENCE:
                continue
            goal.heard = time.monotonic()
            fault = self._watch.fault() if self._watch is not None else ""
            if not fault and goal.acknowledged and not reported:
                fault = "the server is running, but does not know the goal"
            if fault:
                goal.lose(f"no news of {goal.text}: {fault}")
            else:
                goal.send_again()

    def wait(self, timeout: float) -> None:
        """Wait for news of any goal, at most ``timeout`` seconds of wall time."""
        with self._news:
            self._news.wait(timeout)

    def _notify(self) -> None:
        with self._news:
            self._news.notify_all()
