"""End roslaunch when a respawned node fails for good.

``respawn`` of a launch file has no conditions, and ``required`` never restarts a node. So a node with the parameter
``~required`` asks its roslaunch whether that would respawn the node, and ends roslaunch as Ctrl-C does. This module
needs only the standard library, because ROS itself can be missing.
"""

import contextlib
import os
import signal
import sys
import time
import xmlrpc.client
from types import TracebackType
from typing import Any, Dict, Iterator, Optional, Type

from rosoclingo.common.xmlrpc_api import FAULTS, api

#: Seconds of wall time within which a restarted node that fails most probably has the same fault as before.
SOON = 60.0


class RequiredNode:
    """A context manager for the whole of a script, including its imports.

    It ends the roslaunch that would respawn the node if the node has ``~required`` and one of these holds: it did not
    come up, another node has taken its name, or it failed within SOON seconds after a restart.
    """

    def __init__(self) -> None:
        self._up: Optional[float] = None  # time at which the node came up
        self._replaced = False

    def is_up(self, _node: object) -> None:
        """Record that the node has started; call this once, in the node's process."""
        import rospy

        self._up = time.monotonic()
        rospy.core.add_preshutdown_hook(self._ends)

    def _ends(self, reason: str) -> None:
        self._replaced = "new node registered with same name" in reason

    def __enter__(self) -> "RequiredNode":
        return self

    def __exit__(
        self, _kind: Optional[Type[BaseException]], error: Optional[BaseException], _trace: Optional[TracebackType]
    ) -> None:
        failed = bool(error.code) if isinstance(error, SystemExit) else isinstance(error, Exception)
        if self._replaced or (failed and self._up is None):
            _end_launch(starts=1)
        elif failed and self._up is not None and time.monotonic() - self._up < SOON:
            _end_launch(starts=2)


def _end_launch(starts: int) -> None:
    """End the roslaunch of this process if it has started it ``starts`` times and ``~required`` is set."""
    if not any(word.startswith("__log:=") for word in sys.argv):
        return  # not started by roslaunch
    try:
        master = api(os.environ["ROS_MASTER_URI"])
        node = _name()
        if master.getParam(node, f"{node}/required")[2] is not True:
            return
        found = next(_started_by(master.getParam(node, "/roslaunch/uris")[2]), {})
    except (*FAULTS, KeyError) as error:
        sys.stderr.write(f"{sys.argv[0]}: cannot find out whether to end roslaunch: {error}\n")
        return
    if found.get("respawn") and found["spawn_count"] >= starts:
        sys.stderr.write(f"{node}: a restart cannot help: ending roslaunch\n")
        os.kill(os.getppid(), signal.SIGINT)


def _started_by(uris: Any) -> Iterator[Dict[str, Any]]:
    """Yield the process info of this process from its roslaunch; others can be dead or on another machine."""
    found = list(uris.values()) if isinstance(uris, dict) else []
    for uri in found:
        with contextlib.suppress(*FAULTS):
            launch = api(uri)
            if launch.get_pid()[2] == os.getppid():
                for name in launch.get_node_names()[2]:
                    with contextlib.suppress(xmlrpc.client.Error):  # it has no info of a master that it has started
                        info = launch.process_info(name)[2]
                        if info.get("pid") == os.getpid():
                            yield info
            found.extend(launch.list_children()[2])


def _name() -> str:
    """Return the node's name from the arguments of roslaunch."""
    name = next((word for word in sys.argv if word.startswith("__name:=")), "").partition(":=")[2]
    space = os.environ.get("ROS_NAMESPACE", "").strip("/")
    return f"/{space}/{name}" if space else f"/{name}"
