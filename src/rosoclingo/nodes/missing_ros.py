"""Detects in wall time that a part of ROS is missing: its time or its master."""

import os
import time

import rosgraph
import rospy

from rosoclingo.common.xmlrpc_api import FAULTS, api

#: Seconds of wall time after which missing ROS time is reported.
BEGINNING = 2.0


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
