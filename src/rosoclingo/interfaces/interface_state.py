"""How an interface is doing, for /diagnostics."""

from typing import List, Optional

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

PERIOD = 1.0  # seconds of wall time between two reports


class Health:
    """Counts what became of an interface's actions and reports it, with the state of the server, once in a while."""

    def __init__(self, interface: str, server: str) -> None:
        self._interface = interface
        self._server = server
        self._succeeded = 0
        self._failed = 0
        self._last_failure = ""
        self._reported: Optional[float] = None
        self._publisher = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=10)

    def note(self, succeeded: bool, what: str) -> None:
        """An action has ended; `what` says how, for people."""
        if succeeded:
            self._succeeded += 1
        else:
            self._failed += 1
            self._last_failure = what

    def report(self, wall: float, connected: bool, under_way: List[str]) -> None:
        """Publish if the last report is old enough; `wall` is steady time in seconds."""
        if self._reported is not None and wall - self._reported < PERIOD:
            return
        self._reported = wall
        message = DiagnosticArray(status=[self._status(connected, under_way)])
        message.header.stamp = rospy.get_rostime()
        self._publisher.publish(message)

    def _status(self, connected: bool, under_way: List[str]) -> DiagnosticStatus:
        status = DiagnosticStatus(name=f"rosoclingo: interface {self._interface}", hardware_id="rosoclingo")
        status.level = DiagnosticStatus.OK if connected else DiagnosticStatus.WARN
        status.message = ", ".join(under_way) or "idle" if connected else f"server {self._server} is not connected"
        values = {
            "server": self._server,
            "under way": len(under_way),
            "succeeded": self._succeeded,
            "failed": self._failed,
            "last failure": self._last_failure,
        }
        status.values = [KeyValue(key, str(value)) for key, value in values.items()]
        return status
