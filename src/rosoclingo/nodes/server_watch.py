"""Whether an action server is still the one that goals were sent to, by wall time."""

import os
import time
from contextlib import suppress
from typing import Optional

import rosgraph
import rospy

from rosoclingo.common.xmlrpc_api import FAULTS, address_of, api

#: Seconds of wall time without word of a goal after which the server is asked whether it is there.
SILENCE = 5.0

#: Seconds of wall time before a missing begin of ROS time is reported.
BEGINNING = 2.0


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
            return f"{self.node} was restarted"
        return ""

    def _ask(self) -> Optional[int]:
        """Return the node's process id, None where it does not answer."""
        with suppress(*FAULTS):
            return int(api(self._uri).getPid(rospy.get_name())[2]) if self._uri else None
        return None


class Beginning:
    """Detects that ROS time has not begun: there is no /clock, and the core waits for it."""

    def __init__(self) -> None:
        self._since = time.monotonic()
        self._said = False

    def line(self) -> str:
        """Return a text about that, once, after BEGINNING seconds of wall time; else an empty one."""
        if self._said or time.monotonic() - self._since < BEGINNING or rospy.get_time():
            return ""
        self._said = True
        return "ROS time has not begun: waiting for /clock"


def missing_master() -> str:
    """Why there is no ROS master, empty where there is one; asks for some seconds of wall time at most."""
    uri = rosgraph.get_master_uri()
    try:
        api(uri).getPid("/" + str(os.getpid()))
    except FAULTS as error:
        return f"no ROS master at {uri} ({error}): is roscore or roslaunch running?"
    return ""
