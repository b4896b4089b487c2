"""Inquiry about an action of unknown outcome: asks the server for its goal, then checks the world.  No ROS."""

import enum
from typing import Callable, Optional

Check = Callable[[], Optional[bool]]

# Limit in seconds of wall time for the result of an ended goal to arrive.
RESULT_GRACE = 1.0


class ServerReport(enum.Enum):
    """The server's report about a goal."""

    HELD = "the server has the goal, or its result has arrived"
    ENDED = "the goal has ended, and its result has not arrived"
    ABSENT = "the server does not know the goal"


class InquiryResult(enum.Enum):
    """The state of the action."""

    OPEN = "not known yet"
    HELD = "the server has its goal: it is running"
    DONE = "it was done"
    NOT_DONE = "it was not done"
    UNKNOWN = "its outcome is unknown"


class Inquiry:
    """An inquiry of at most ``limit`` seconds from the wall time ``wall``; ``check`` checks the world, if possible."""

    def __init__(self, check: Optional[Check], limit: float, wall: float) -> None:
        self._check = check
        self._end = wall + limit
        self._ended_since: Optional[float] = None
        self.used = False  # the server has ended the goal, and accepts no other goal with that id

    def look(self, report: Optional[ServerReport], wall: float) -> InquiryResult:
        """Return the result at the time ``wall``, given the server's ``report`` (None before the first)."""
        if report is ServerReport.HELD:
            return InquiryResult.HELD
        expired = wall >= self._end
        waits = report is None or self._can_arrive(report, wall)
        if waits and not expired:
            return InquiryResult.OPEN
        done = self._check() if self._check is not None else None
        if done or (done is not None and not waits):  # an unreachable server can still do the action
            return InquiryResult.DONE if done else InquiryResult.NOT_DONE
        return InquiryResult.UNKNOWN if expired or self._check is None else InquiryResult.OPEN

    def _can_arrive(self, report: ServerReport, wall: float) -> bool:
        """Return whether the result of an ended goal can still arrive."""
        self.used = report is ServerReport.ENDED
        if not self.used:
            return False
        if self._ended_since is None:
            self._ended_since = wall
        return wall - self._ended_since < RESULT_GRACE
