"""Whether an action that may have been begun was done: the server is asked for its goal, then the world.  No ROS."""

import enum
from typing import Callable, Optional

Check = Callable[[], Optional[bool]]

# Seconds of wall time that the result of a goal which has ended may take to arrive.
RESULT_GRACE = 1.0


class Listed(enum.Enum):
    """What the server says of a goal that was sent."""

    HELD = "it has the goal, or its result has come"
    ENDED = "the goal has ended, and nobody has heard its result"
    ABSENT = "it does not know the goal"


class InquiryResult(enum.Enum):
    """What has become of the action."""

    OPEN = "not known yet"
    HELD = "the server has its goal: it is under way"
    DONE = "it was done"
    NOT_DONE = "it was not done"
    UNKNOWN = "it cannot be told"


class Inquiry:
    """Asks for at most ``limit`` seconds of wall time from ``wall`` on. ``check`` asks the world, if anything can."""

    def __init__(self, check: Optional[Check], limit: float, wall: float) -> None:
        self._check = check
        self._end = wall + limit
        self._ended_since: Optional[float] = None
        self.used = False  # the server has ended the goal: it takes no other of that id

    def look(self, listed: Optional[Listed], wall: float) -> InquiryResult:
        """The finding at the time ``wall`` if the server says ``listed``; None while it has said nothing."""
        if listed is Listed.HELD:
            return InquiryResult.HELD
        expired = wall >= self._end
        waits = listed is None or self._may_come(listed, wall)
        if waits and not expired:
            return InquiryResult.OPEN
        done = self._check() if self._check is not None else None
        if done or (done is not None and not waits):  # a server that is out of reach can still do it
            return InquiryResult.DONE if done else InquiryResult.NOT_DONE
        return InquiryResult.UNKNOWN if expired or self._check is None else InquiryResult.OPEN

    def _may_come(self, listed: Listed, wall: float) -> bool:
        """Whether the result of a goal that has ended may be on its way."""
        self.used = listed is Listed.ENDED
        if not self.used:
            return False
        if self._ended_since is None:
            self._ended_since = wall
        return wall - self._ended_since < RESULT_GRACE
