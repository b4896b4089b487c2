"""A clock for time limits on computation, at any pace of simulated time."""

from typing import Optional, Tuple


class PacedClock:
    """Counts seconds of ROS time from its first use, never faster than wall time, and never backwards.

    In a simulation at tenfold speed, a minute of compiling would otherwise count as ten minutes.
    """

    def __init__(self) -> None:
        self._elapsed = 0.0
        self._last: Optional[Tuple[float, float]] = None

    def at(self, ros: float, wall: float) -> float:
        """Return the counted seconds at the ROS time ``ros`` and the steady wall time ``wall``."""
        if self._last is not None:
            self._elapsed += max(0.0, min(ros - self._last[0], wall - self._last[1]))
        self._last = (ros, wall)
        return self._elapsed
