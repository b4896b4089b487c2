"""Detects in wall time that an action server has died or was restarted."""

import os
import time
from contextlib import suppress
from typing import Optional

import rosgraph
import rospy

from rosoclingo.common.xmlrpc_api import FAULTS, address_of, api

#: Seconds of wall time without news of a goal after which the server's node is checked.
SILENCE = 5.0

#: Seconds of wall time after which missing ROS time is reported.
BEGINNING = 2.0


class ServerWatch:
    """The process behind an action server.

    A server publishes its status in ROS time, which can stand still. So a silent server is first checked through its
    node's XML-RPC interface, in wall time.
    """

    def __init__(self, node: str) -> None:
        """Watch the running node ``node``."""
        self.node = node
        self._uri = ""
        with suppress(*FAULTS):
            self._uri = address_of(node)
        self._process = self._ask()

    def fault(self) -> str:
        """Return why the server is gone, empty if it is running; takes some seconds if the node does not respond."""
        process = self._ask()
        if process is None:
            return f"{self.node} does not respond any more"
        if self._process is not None and process != self._process:
            return f"{self.node} was restarted"
        return ""

    def _ask(self) -> Optional[int]:
        """Return the node's process id, None if the node does not respond."""
        with suppress(*FAULTS):
            return int(api(self._uri).getPid(rospy.get_name())[2]) if self._uri else None
        return None


class Beginning:
    """Detects that ROS time has not begun: there is no /clock, and the core waits for it."""

    def __init__(self) -> None:
        self._since = time.monotonic()
        self._reported = False

    def line(self) -> str:
        """Return a message, once, after BEGINNING seconds of wall time without ROS time; else an empty text."""
        if self._reported or time.monotonic() - self._since < BEGINNING or rospy.get_time():
            return ""
        self._reported = True
        return "ROS time has not begun: waiting for /clock"


def missing_master() -> str:
    """Return why no ROS master responds, empty if one does; takes at most some seconds of wall time."""
    uri = rosgraph.get_master_uri()
    try:
        api(uri).getPid("/" + str(os.getpid()))
    except FAULTS as error:
        return f"no ROS master at {uri} ({error}): is roscore or roslaunch running?"
    return ""
