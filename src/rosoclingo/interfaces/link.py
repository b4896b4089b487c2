"""The client of one actionlib server: its connection, goals and their progress."""

import time
import uuid
import weakref
from collections import OrderedDict
from typing import Any, Callable, Dict, Optional, Tuple

import rospy
from actionlib.action_client import ActionClient, ClientGoalHandle, CommState, CommStateMachine, TerminalState
from actionlib_msgs.msg import GoalID, GoalStatus

from rosoclingo.common.action_clients import cancel_goal, goal_id
from rosoclingo.common.connections import close_dead, connected_nodes, readers
from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.interfaces.attempt import CANCELLED, ActionEvent
from rosoclingo.interfaces.templates import GoalEnd

# Seconds of wall time without a connection after which a server counts as gone.
CONNECTION_GRACE = 1.0

# Seconds of wall time after which a connected server counts as writing to this node, even if it does not report that.
WRITING_GRACE = 5.0

RESULTS = 100  # limit of cached results of this node's goals, the latest

_ACKNOWLEDGING = (
    CommState.PENDING,
    CommState.ACTIVE,
    CommState.RECALLING,
    CommState.PREEMPTING,
    CommState.WAITING_FOR_RESULT,
)

_OPEN = (GoalStatus.PENDING, GoalStatus.ACTIVE, GoalStatus.PREEMPTING, GoalStatus.RECALLING)


class ServerLink:
    """An ActionClient that reports whether its server is connected, and caches the results of goals.

    actionlib's `wait_for_server` blocks, and measures its time-out in simulated time, which can stand still.
    """

    def __init__(self, server: str, action_type: type) -> None:
        self._results: OrderedDict[str, Any] = OrderedDict()  # of this node's goals, by id, for goals tracked later
        kind = type(action_type().action_result)
        self._result_sub = rospy.Subscriber(rospy.remap_name(server) + "/result", kind, self._keep)
        # a node that shuts down loses cancels in a queue
        prompt_publisher(rospy.remap_name(server) + "/cancel", GoalID)
        self._client = ActionClient(server, action_type)
        self._down_since: Optional[float] = None
        self._met: Dict[str, float] = {}  # connected servers, and when they count as writing to us

    @property
    def connected(self) -> bool:
        """Whether a single node receives goals and cancels, and sends status and results.

        The names are compared, because a recorder of these topics is connected as well.
        """
        client, now = self._client, time.monotonic()
        servers = connected_nodes(client.status_sub.impl) & connected_nodes(client.result_sub.impl)
        inlets = client.pub_goal.impl, client.pub_cancel.impl
        found = [server for server in servers if all(one.has_connection(server) for one in inlets)]
        for connection in client.status_sub.impl.connections:
            if connection.callerid_pub in set(found) - self._met.keys():
                close_dead(connection)
        self._met = {server: self._met.get(server, now + WRITING_GRACE) for server in found}
        return any(self._is_written_to_by(server, now) for server in found)

    def _is_written_to_by(self, server: str, now: float) -> bool:
        """Return whether the server's messages arrive: rospy counts a connection at this end first."""
        if now < self._met[server]:
            topics, written = (self._client.status_sub.name, self._client.result_sub.name), readers(server) or {}
            if not all(rospy.get_name() in written.get(topic, ()) for topic in topics):
                return False
            self._met[server] = now
        return True

    @property
    def starting(self) -> bool:
        """Whether the server has been announced, but is not ready yet: it can load or compile for a while."""
        return self._client.status_sub.get_num_connections() > 0 and not self.connected

    def gone(self, wall: float) -> bool:
        """Return whether no server has been connected for CONNECTION_GRACE; `wall` is steady time in seconds."""
        if connected_nodes(self._client.status_sub.impl):
            self._down_since = None
            return False
        if self._down_since is None:
            self._down_since = wall
        return wall - self._down_since >= CONNECTION_GRACE

    def track(self, goal: Any, identity: str, changed: Callable[[], None]) -> ClientGoalHandle:
        """Track the goal with this id, which was sent before or is sent next.

        `changed` is called on rospy's threads and must only enqueue. actionlib's ``send_goal`` chooses the id itself,
        but this node needs the id before it sends the goal and after a crash.
        """
        client = self._client
        message = client.ActionGoal(goal_id=GoalID(id=identity), goal=goal)
        machine = CommStateMachine(message, lambda _handle: changed(), None, client.pub_goal.publish, None)
        with client.manager.list_mutex:
            client.manager.statuses.append(weakref.ref(machine))
        result = self._results.get(identity)
        if result is not None:
            machine.update_result(result)
        return ClientGoalHandle(machine)

    def send(self, handle: ClientGoalHandle) -> None:
        """Send a goal; a server that already has the goal does not start it twice."""
        message = handle.comm_state_machine.action_goal
        message.header.stamp = message.goal_id.stamp = rospy.get_rostime()
        handle.comm_state_machine.send_goal_fn(message)

    @property
    def last_status(self) -> Any:
        """The server's last status message, None before the first."""
        return self._client.last_status_msg

    def look_up(self, handle: ClientGoalHandle, stale: Any) -> Optional[ActionEvent]:
        """Return what the server reports about an earlier goal in a status message newer than `stale`.

        FOUND: it has the goal, or the result has arrived; ENDED: the result has not arrived; SERVER_LOST: it does not
        know the goal. None before that message.
        """
        if handle.get_comm_state() == CommState.DONE and handle.get_result() is not None:
            return ActionEvent.FOUND
        message = self._client.last_status_msg
        if message is None or message is stale or not self.connected:
            return None
        wanted = goal_id(handle)
        status = next((one.status for one in message.status_list if one.goal_id.id == wanted), None)
        if status is None:
            return ActionEvent.SERVER_LOST
        return ActionEvent.FOUND if status in _OPEN else ActionEvent.ENDED

    def cancel(self, handle: ClientGoalHandle) -> None:
        """Cancel a goal, acknowledged or not."""
        cancel_goal(self._client, handle)

    def _keep(self, result: Any) -> None:
        identity = result.status.goal_id.id
        if identity.startswith(f"{rospy.get_name()}-"):
            self._results[identity] = result
            while len(self._results) > RESULTS:
                self._results.popitem(last=False)


def progress(handle: ClientGoalHandle) -> Tuple[Optional[ActionEvent], Optional[GoalEnd]]:
    """Return the event of a goal's present state (None before the server has acknowledged the goal), and its end."""
    state = handle.get_comm_state()
    if state in _ACKNOWLEDGING:
        return ActionEvent.ACKNOWLEDGED, None
    if state != CommState.DONE:
        return None, None
    status = TerminalState.to_string(handle.get_terminal_state()).lower()
    if status == "lost":
        return ActionEvent.SERVER_LOST, None
    ended = GoalEnd(status, handle.get_goal_status_text(), handle.get_result())
    return ActionEvent.PREEMPTED if status in CANCELLED else ActionEvent.ENDED, ended


def new_goal_id() -> str:
    """Return a goal id that is unique, also across restarts of this node."""
    return f"{rospy.get_name()}-{uuid.uuid4().hex}"
