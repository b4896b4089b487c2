"""A client of the core's action server, for one goal."""

import threading
import time
from contextlib import suppress
from typing import Any, Optional

import rospy
from actionlib import ActionClient, ClientGoalHandle, CommState
from actionlib_msgs.msg import GoalStatus

from rosoclingo.common.action_clients import cancel_goal, goal_id
from rosoclingo.common.connections import is_delivered_to
from rosoclingo.common.xmlrpc_api import FAULTS, address_of, api
from rosoclingo.msg import ROSoClingoAction, ROSoClingoFeedback, ROSoClingoGoal
from rosoclingo.runs.events import STATUS_WORDS

#: Seconds of wall time without news of a goal after which its server is checked.
SILENCE = 5.0


class GoalClient:
    """Sends a goal to the core's action server, and follows it.

    Attributes:
        text: the goal.
        outcome: a word of STATUS_WORDS, empty until the end of the goal.
        message: the reason of the end.
        feedback: the latest feedback, None before the first.
        node: the name of the server's node, empty before ``wait_for_server``.

    """

    def __init__(self, server: str) -> None:
        self._client = ActionClient(server, ROSoClingoAction)
        self._news = threading.Condition()
        self.node = self._uri = ""
        self._handle: Optional[ClientGoalHandle] = None
        self._latest: Any = None  # status message
        self._heard = 0.0  # time of the last news of the goal, or of its sending
        self._cancelled = False
        self.text = self.outcome = self.message = ""
        self.feedback: Optional[ROSoClingoFeedback] = None

    def wait_for_server(self, timeout: float) -> bool:
        """Wait until client and server are connected, at most ``timeout`` s of wall time; return whether they are."""
        end = time.monotonic() + timeout
        while time.monotonic() < end and not rospy.is_shutdown():
            # actionlib's wait_for_server has its time-out in ROS time, which can stand still or not have begun
            status = self._client.last_status_msg
            server = "" if status is None else status._connection_header["callerid"]
            if server and self._is_connected(server):
                self.node = server
                with suppress(*FAULTS):
                    self._uri = address_of(server)
                return True
            self.wait(0.02)
        return False

    def _is_connected(self, server: str) -> bool:
        client, me = self._client, rospy.get_name()
        heard = all(one.impl.has_connection(server) for one in (client.pub_goal, client.pub_cancel))
        topics = (client.feedback_sub.resolved_name, client.result_sub.resolved_name)
        return heard and all(is_delivered_to(me, topic, [server]) for topic in topics)

    def send(self, text: str) -> None:
        """Send the goal; call this once."""
        self.text, self._heard = text, time.monotonic()
        self._handle = self._client.send_goal(ROSoClingoGoal(text), self._on_transition, self._on_feedback)

    def cancel(self) -> None:
        """Ask the server to cancel the goal, acknowledged or not; the goal ends when the server ends it."""
        self._cancelled = True
        cancel_goal(self._client, self._handle)

    def check(self) -> None:
        """End the goal if it is lost; call this while waiting for it.

        A goal without news for SILENCE seconds of wall time is lost if the server no longer reports the acknowledged
        goal, or does not respond, which takes some seconds. A server publishes its status in ROS time, which can stand
        still, so its node is asked in wall time.
        """
        assert self._handle is not None
        before, self._latest = self._latest, self._client.last_status_msg
        known = {one.goal_id.id for one in self._latest.status_list} if self._latest is not None else set()
        reported, now = goal_id(self._handle) in known, time.monotonic()
        if reported and self._latest is not before:
            self._heard = now
        if self.outcome or now - self._heard < SILENCE:
            return
        self._heard = now
        acknowledged = self._handle.get_comm_state() != CommState.WAITING_FOR_GOAL_ACK
        if not self._responds():
            self._end(GoalStatus.LOST, f"no news of {self.text}: {self.node} does not respond any more")
        elif acknowledged and not reported:
            self._end(GoalStatus.LOST, f"no news of {self.text}: the server is running, but does not know the goal")
        elif not acknowledged:  # rospy can drop the goal and its cancel, and the server accepts an id only once
            self._client.pub_goal.publish(self._handle.comm_state_machine.action_goal)
            if self._cancelled:
                self.cancel()

    def _responds(self) -> bool:
        with suppress(*FAULTS):
            return bool(api(self._uri).getPid(rospy.get_name()))
        return False

    def wait(self, timeout: float) -> None:
        """Wait for news of the goal, at most ``timeout`` seconds of wall time."""
        with self._news:
            self._news.wait(timeout)

    def _on_transition(self, handle: ClientGoalHandle) -> None:
        if handle.get_comm_state() == CommState.DONE:
            result = handle.get_result()
            status = handle.get_terminal_state()
            message = result.message if result is not None and result.message else handle.get_goal_status_text()
            lost = status == GoalStatus.LOST
            self._end(status, f"the server no longer knows {self.text}" if lost else message)

    def _end(self, status: int, message: str) -> None:
        if not self.outcome:
            self.message, self.outcome = message, STATUS_WORDS[status]
            self._notify()

    def _on_feedback(self, _handle: ClientGoalHandle, feedback: ROSoClingoFeedback) -> None:
        self.feedback, self._heard = feedback, time.monotonic()
        self._notify()

    def _notify(self) -> None:
        with self._news:
            self._news.notify_all()
