"""The time by which patience is measured."""

import time
from typing import Callable

FASTEST = 20.0  # s a second


class PatienceClock:
    """Goes with ROS time, but at most ``FASTEST`` times as fast as the wall clock (``wall``, s).

    In a free running simulation 15 s of patience may be a tenth of a second: without this a process that had to wait
    that long for a processor, here or beside, would cost a goal.
    """

    def __init__(self, wall: Callable[[], float] = time.monotonic) -> None:
        self._wall = wall
        self.now = 0.0
        self._seen = (0.0, wall())

    def see(self, now: float) -> float:
        """Take the ROS time (s) and return this clock's: it goes back when ROS time does."""
        (last, last_wall), wall = self._seen, self._wall()
        self._seen = (now, wall)
        self.now += min(now - last, FASTEST * (wall - last_wall))
        return self.now
