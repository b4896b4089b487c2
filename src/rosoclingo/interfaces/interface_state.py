"""The health of an interface, for /diagnostics and the log."""

import traceback
from typing import Callable, List, Set, Tuple

import rospy
from diagnostic_msgs.msg import DiagnosticStatus

from rosoclingo.common.diagnostics import Diagnostics, Findings


class InterfaceHealth:
    """Counts an interface's successes, failures and internal errors, and reports them with the state of the server.

    ``look`` returns whether the server is connected, and the running actions.
    """

    def __init__(self, interface: str, server: str, look: Callable[[], Tuple[bool, List[str]]]) -> None:
        self._interface, self._server, self._look = interface, server, look
        self._succeeded = self._failed = self._faults = 0
        self._last_failure = self._last_fault = self._fault = ""
        self._told: Set[str] = set()
        self.trouble = ""  # a problem other than with the server
        self._diagnostics = Diagnostics(f"rosoclingo: interface {interface}", self._describe)
        self.tick = self._diagnostics.tick

    def note(self, succeeded: bool, what: str) -> None:
        """Record the end of an action; `what` describes it."""
        if succeeded:
            self._succeeded += 1
            self._fault = ""
        else:
            self._failed += 1
            self._last_failure = what

    def fault(self, error: Exception) -> str:
        """Record the exception that is being handled, and return it as one line.

        Its traceback is logged once; the status is an error until an action succeeds.
        """
        self._faults += 1
        self._fault = self._last_fault = f"internal error: {type(error).__name__}: {error}"
        place = "".join(traceback.format_tb(error.__traceback__))
        if place not in self._told:
            self._told.add(place)
            rospy.logerr("%s: %s", self._interface, self._fault, exc_info=True)
        return self._fault

    def _describe(self) -> Findings:
        connected, running = self._look()
        level, text = DiagnosticStatus.OK, ", ".join(running) or "idle"
        if self._fault:
            level, text = DiagnosticStatus.ERROR, self._fault
        elif not connected:
            level, text = DiagnosticStatus.WARN, f"server {self._server} is not connected"
        elif self.trouble:
            level, text = DiagnosticStatus.WARN, self.trouble
        values = {
            "server": self._server,
            "under way": len(running),
            "succeeded": self._succeeded,
            "failed": self._failed,
            "last failure": self._last_failure,
            "faults": self._faults,
            "last fault": self._last_fault,
        }
        return level, text, values
