"""A node that its roslaunch starts again whenever it ends, and an end for that where no start can help.

``respawn`` of a launch file has no conditions, and ``required`` starts nothing again. So a node with the parameter
``~required`` asks the roslaunch that has started it whether it would do so again, and ends it as Ctrl-C does. This
module needs the standard library alone, as what a script lacks may be ROS itself.
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

__all__ = ["Required"]

#: Seconds of wall time in which a node that was started again and fails has the same fault as before, most probably.
SOON = 60.0


class Required:
    """For a ``with`` statement around all that a script does, imports included.

    Where the node has ``~required`` and has not come up, another node has taken its name, or it fails within SOON
    seconds of having been started again, the roslaunch ends that would start it.
    """

    def __init__(self) -> None:
        self._up: Optional[float] = None  # when it came up
        self._replaced = False

    def is_up(self, _node: object) -> None:
        """The node has started; call it in that process once."""
        import rospy

        self._up = time.monotonic()
        rospy.core.add_preshutdown_hook(self._ends)

    def _ends(self, reason: str) -> None:
        self._replaced = "new node registered with same name" in reason

    def __enter__(self) -> "Required":
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
    """End the roslaunch that would start this process again, if it has started it so often, and if it shall end."""
    if not any(word.startswith("__log:=") for word in sys.argv):
        return  # by hand
    try:
        master = api(os.environ["ROS_MASTER_URI"])
        node = _name()
        if master.getParam(node, f"{node}/required")[2] is not True:
            return
        found = next(_started_by(master.getParam(node, "/roslaunch/uris")[2]), {})
    except (*FAULTS, KeyError) as error:
        sys.stderr.write(f"{sys.argv[0]}: whether to end its roslaunch is not known: {error}\n")
        return
    if found.get("respawn") and found["spawn_count"] >= starts:
        sys.stderr.write(f"{node}: to start it again cannot help: roslaunch ends\n")
        os.kill(os.getppid(), signal.SIGINT)


def _started_by(uris: Any) -> Iterator[Dict[str, Any]]:
    """Yield what the roslaunch says of this process that has started it; roslaunches may have gone, or be elsewhere."""
    found = list(uris.values()) if isinstance(uris, dict) else []
    for uri in found:
        with contextlib.suppress(*FAULTS):
            launch = api(uri)
            if launch.get_pid()[2] == os.getppid():
                yield from (info for info in _processes(launch) if info.get("pid") == os.getpid())
            found.extend(launch.list_children()[2])


def _processes(launch: Any) -> Iterator[Dict[str, Any]]:
    """Yield what a roslaunch says of its processes; of a master that it has started it cannot."""
    for name in launch.get_node_names()[2]:
        with contextlib.suppress(xmlrpc.client.Error):
            yield launch.process_info(name)[2]


def _name() -> str:
    """The node's name as roslaunch gives it."""
    name = next((word for word in sys.argv if word.startswith("__name:=")), "").partition(":=")[2]
    space = os.environ.get("ROS_NAMESPACE", "").strip("/")
    return f"/{space}/{name}" if space else f"/{name}"
