"""Whether an action server is still the one that goals were sent to, whatever ROS time does."""

import os
import threading
import time
from contextlib import suppress
from typing import Optional

import rosgraph
import rospy
from actionlib_msgs.msg import GoalStatusArray

from rosoclingo.common.xmlrpc_api import FAULTS, address_of, api

#: Seconds of wall time without word of a goal after which the server is asked whether it is there.
SILENCE = 5.0

#: Such silences in a row after which a server that is there, and tells of its goals, has never got a goal.
UNHEARD = 3


class ServerWatch:
    """The process behind an action server.

    A server tells its status by ROS time, which may stand still; so one that is silent is asked by its node's XML-RPC
    interface, in wall time, before it is taken for gone.
    """

    def __init__(self, node: str) -> None:
        """Take the name of the server's node, which is there now."""
        self.node = node
        self._uri = ""
        with suppress(*FAULTS):
            self._uri = address_of(node)
        self._process = self._ask()

    def fault(self) -> str:
        """Why the server is no longer there, empty where it is; takes some seconds where nothing answers."""
        process = self._ask()
        if process is None:
            return f"{self.node} does not answer any more"
        if self._process is not None and process != self._process:
            return f"{self.node} was started anew"
        return ""

    def _ask(self) -> Optional[int]:
        """Return the node's process id, None where it does not answer."""
        with suppress(*FAULTS):
            return int(api(self._uri).getPid(rospy.get_name())[2]) if self._uri else None
        return None


class Silence:
    """Counts the turns of SILENCE seconds of wall time in which nothing was heard of a goal."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # feedback comes in a thread of its own
        self.end()

    def end(self, status: Optional[GoalStatusArray] = None) -> None:
        """Start counting anew: the goal was heard of, when ``status`` was the last one of the server."""
        with self._lock:
            self._since = time.monotonic()
            self._turns = 0
            self._status, self._denied = status, False

    def deny(self, status: GoalStatusArray) -> None:
        """The server has told its status without the goal in it."""
        with self._lock:
            self._denied |= status is not self._status

    @property
    def denied(self) -> bool:
        """Whether the server's status was heard since, without the goal in it."""
        return self._denied

    def turn(self) -> int:
        """Return how many turns have passed where one ends just now, else 0."""
        turns = int((time.monotonic() - self._since) / SILENCE)
        fresh = turns > self._turns
        self._turns = turns
        return turns if fresh else 0


def missing_master() -> str:
    """Why there is no ROS master, empty where there is one; asks for some seconds of wall time at most."""
    uri = rosgraph.get_master_uri()
    try:
        api(uri).getPid("/" + str(os.getpid()))
    except FAULTS as error:
        return f"no ROS master at {uri} ({error}): is roscore or roslaunch running?"
    return ""
