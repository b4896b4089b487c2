"""Progress of the robot towards its goal."""

import math
from typing import Optional, Tuple

from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.navigation_types import NavigatorLimits

# Additional length (m) that makes a new path a detour; the maximum number of detours ends hopeless goals.
DETOUR_LENGTH, DETOUR_LIMIT = 1.0, 20


class PathProgress:
    """Tracks the shortest remaining path, and the time since the last progress (s).

    ``detours``: number of changes to a longer path.
    """

    def __init__(self, limits: NavigatorLimits, now: float) -> None:
        self._limits = limits
        self._best = self._least = math.inf
        self.detours = 0
        self.restart(now)

    def restart(self, now: float) -> None:
        """Restart all timeouts."""
        self._last = now
        self._oscillation: Tuple[float, Optional[Pose2D]] = (now, None)

    def set_path(self, now: float, length: float) -> None:
        """Adopt the length (m) of a new path. A shorter path does not count as progress; only driving does."""
        if length > self._best + DETOUR_LENGTH and self.detours < DETOUR_LIMIT:
            # The detour gets time of its own, but does not reset the recovery behaviours.
            self._best, self._last, self.detours = length, now, self.detours + 1
        else:
            self._best = min(self._best, length)

    def update(self, now: float, length: float) -> bool:
        """Update the remaining length (m). Return whether it is a new minimum, by at least oscillation_distance."""
        if length < self._best - self._limits.oscillation_distance:
            self._best, self._last = length, now
        if length >= self._least - self._limits.oscillation_distance:
            return False
        self._least = length
        return True

    def stuck(self, now: float) -> str:
        """Return a message if the remaining path has not become shorter for progress_timeout, else an empty text.

        The timeout grows with the remaining length, by 1 s per m.
        """
        timeout = self._limits.progress_timeout
        if timeout <= 0 or now - self._last <= timeout + self._best:
            return ""
        return f"the remaining path has not become shorter for {now - self._last:.0f} s"

    def oscillates(self, now: float, pose: Pose2D) -> str:
        """Return a message if the robot has stayed in one place for oscillation_timeout, else an empty text."""
        since, place = self._oscillation
        if place is None or place.distance(pose) >= self._limits.oscillation_distance:
            self._oscillation = (now, pose)
            return ""
        timeout = self._limits.oscillation_timeout
        if timeout <= 0 or now - since <= timeout:
            return ""
        return f"the robot moved less than {self._limits.oscillation_distance} m in {now - since:.0f} s"
