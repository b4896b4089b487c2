"""Clock for the timeouts of navigation."""

import time
from typing import Callable

MAX_SPEED = 20.0  # relative to the wall clock


class PatienceClock:
    """Follows ROS time, but at most ``MAX_SPEED`` times as fast as the wall clock (``wall``, s).

    In a simulation that runs as fast as it can, 15 s of patience can be a tenth of a second. Without this limit, a
    short delay of any process would abort the goal.
    """

    def __init__(self, wall: Callable[[], float] = time.monotonic) -> None:
        self._wall = wall
        self.now = 0.0
        self._seen = (0.0, wall())

    def update(self, now: float) -> float:
        """Update to the ROS time (s), which can also go back. Return the time (s) of this clock."""
        (last, last_wall), wall = self._seen, self._wall()
        self._seen = (now, wall)
        self.now += min(now - last, MAX_SPEED * (wall - last_wall))
        return self.now
