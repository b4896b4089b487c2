"""The client of one actionlib server: whether it is connected, goals sent to it, and their progress."""

import threading
import time
from typing import Any, Callable, Dict, Iterable, Optional, Set

import rospy
from actionlib.action_client import ActionClient, ClientGoalHandle, CommState, TerminalState

from rosoclingo.common.action_clients import cancel_goal
from rosoclingo.common.connections import readers
from rosoclingo.interfaces.action_runs import Event
from rosoclingo.interfaces.templates import Ended

# Seconds of wall time that the connection to a server may be down before the server counts as gone.
CONNECTION_GRACE = 1.0

# Seconds of wall time that a server which is connected, but does not say that it writes to this node, is waited for.
WRITING_GRACE = 5.0

STATUS_NAMES = {
    TerminalState.SUCCEEDED: "succeeded",
    TerminalState.ABORTED: "aborted",
    TerminalState.REJECTED: "rejected",
    TerminalState.PREEMPTED: "preempted",
    TerminalState.RECALLED: "recalled",
}

_ACKNOWLEDGING = (
    CommState.PENDING,
    CommState.ACTIVE,
    CommState.RECALLING,
    CommState.PREEMPTING,
    CommState.WAITING_FOR_RESULT,
)

_CANCELLING = (CommState.RECALLING, CommState.PREEMPTING, CommState.WAITING_FOR_RESULT, CommState.DONE)

Report = Callable[[Event, Optional[Ended]], None]


class ServerLink:
    """An ActionClient that can be asked whether its server is connected, and that reports progress as Events.

    actionlib's own `wait_for_server` blocks, and measures its time-out in simulated time, which may stand still.
    """

    def __init__(self, server: str, action_type: type) -> None:
        self._client = ActionClient(server, action_type)
        self._down_since: Optional[float] = None
        self._met: Dict[str, float] = {}  # connected servers, and when they count as writing to us
        self._changed = threading.Condition()

    @property
    def connected(self) -> bool:
        """True if one server hears goals and cancels and is heard with status and result.

        Names are compared, because a recorder of these topics is connected as well.
        """
        client, now = self._client, time.monotonic()
        servers = _publishers(client.status_sub) & _publishers(client.result_sub)
        inlets = client.pub_goal.impl, client.pub_cancel.impl
        found = [server for server in servers if all(one.has_connection(server) for one in inlets)]
        self._met = {server: self._met.get(server, now + WRITING_GRACE) for server in found}
        return any(self._is_written_to_by(server, now) for server in found)

    def _is_written_to_by(self, server: str, now: float) -> bool:
        """Whether what the server publishes comes here: rospy counts a connection at this end first."""
        if now < self._met[server]:
            topics, written = (self._client.status_sub.name, self._client.result_sub.name), readers(server) or {}
            if not all(rospy.get_name() in written.get(topic, ()) for topic in topics):
                return False
            self._met[server] = now
        return True

    @property
    def starting(self) -> bool:
        """True if somebody has announced the server, but does not serve yet: it may load or compile for a while."""
        return self._client.status_sub.get_num_connections() > 0 and not self.connected

    def gone(self, wall: float) -> bool:
        """True if no server has been heard for a while; `wall` is steady time in seconds."""
        if self._client.status_sub.get_num_connections() > 0:
            self._down_since = None
            return False
        if self._down_since is None:
            self._down_since = wall
        return wall - self._down_since >= CONNECTION_GRACE

    def send(self, goal: Any, report: Report) -> ClientGoalHandle:
        """Send a goal; `report` is called on rospy's threads and may only enqueue."""
        return self._client.send_goal(goal, transition_cb=lambda handle: self._transition(handle, report))

    def cancel(self, handle: ClientGoalHandle) -> None:
        """Cancel a goal, acknowledged or not."""
        cancel_goal(self._client, handle)

    def wait_for_cancels(self, handles: Iterable[ClientGoalHandle], timeout: float) -> bool:
        """Wait until the server knows of the cancels of these goals, at most ``timeout`` seconds of wall time.

        A node that ends before loses what rospy has not sent yet.
        """
        goals = list(handles)
        with self._changed:
            return self._changed.wait_for(lambda: all(one.get_comm_state() in _CANCELLING for one in goals), timeout)

    def _transition(self, handle: ClientGoalHandle, report: Report) -> None:
        _report_transition(handle, report)
        with self._changed:
            self._changed.notify_all()


def _report_transition(handle: ClientGoalHandle, report: Report) -> None:
    state = handle.get_comm_state()
    if state in _ACKNOWLEDGING:
        report(Event.ACKNOWLEDGED, None)
    elif state == CommState.DONE:
        status = STATUS_NAMES.get(handle.get_terminal_state())
        if status is None:
            report(Event.SERVER_LOST, None)
        else:
            report(Event.ENDED, Ended(status, handle.get_goal_status_text(), handle.get_result()))


def _publishers(subscriber: Any) -> Set[str]:
    return {connection.callerid_pub for connection in subscriber.impl.connections}
