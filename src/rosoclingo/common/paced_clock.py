"""A clock for time limits on work that takes processor time, at any pace of simulated time."""

from typing import Optional, Tuple


class PacedClock:
    """Counts seconds of ROS time from the first look at it, but never faster than wall time, and never back.

    A node that compiles or loads for a minute would be late by ten minutes of a simulation that runs ten times faster.
    """

    def __init__(self) -> None:
        self._elapsed = 0.0
        self._last: Optional[Tuple[float, float]] = None

    def at(self, ros: float, wall: float) -> float:
        """Return the seconds counted when ROS time is ``ros`` and a steady wall clock shows ``wall``."""
        if self._last is not None:
            self._elapsed += max(0.0, min(ros - self._last[0], wall - self._last[1]))
        self._last = (ros, wall)
        return self._elapsed
