"""Whether the robot comes any nearer to its goal."""

import math
from typing import Optional, Tuple

from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.navigation_types import NavigatorLimits

# A new way is a detour when it is that much (m) longer; a bound keeps a hopeless goal from lasting for ever.
DETOUR, MOST_DETOURS = 1.0, 20


class WayProgress:
    """Keeps how much of the way was left at least, and since when the robot has come no further; times in s.

    ``detours``: how often a way was left for a longer one.
    """

    def __init__(self, limits: NavigatorLimits, now: float) -> None:
        self._limits = limits
        self._best = self._least = math.inf
        self.detours = 0
        self.renew(now)

    def renew(self, now: float) -> None:
        """Start all patience anew."""
        self._last = now
        self._oscillation: Tuple[float, Optional[Pose2D]] = (now, None)

    def take_way(self, now: float, length: float) -> None:
        """Take a new way's length (m) for what there is left to drive; only to have driven is progress."""
        if length > self._best + DETOUR and self.detours < MOST_DETOURS:
            # The way is blocked and another one known: that takes its time, but renews no recovery.
            self._best, self._last, self.detours = length, now, self.detours + 1
        else:
            self._best = min(self._best, length)

    def see(self, now: float, length: float) -> bool:
        """Take what is left (m) of the way: half a metre less is progress. Tell whether it is less than ever."""
        if length < self._best - self._limits.oscillation_distance:
            self._best, self._last = length, now
        if length >= self._least - self._limits.oscillation_distance:
            return False
        self._least = length
        return True

    def stuck(self, now: float) -> str:
        """Return in words that the way left has not become shorter for progress_timeout, the way aside; else empty."""
        timeout = self._limits.progress_timeout
        if timeout <= 0 or now - self._last <= timeout + self._best:
            return ""
        return f"the way left has not become shorter for {now - self._last:.0f} s"

    def oscillates(self, now: float, pose: Pose2D) -> str:
        """Return in words that the robot has stayed where it is for oscillation_timeout; else empty."""
        since, place = self._oscillation
        if place is None or place.distance(pose) >= self._limits.oscillation_distance:
            self._oscillation = (now, pose)
            return ""
        timeout = self._limits.oscillation_timeout
        if timeout <= 0 or now - since <= timeout:
            return ""
        return f"it moved less than {self._limits.oscillation_distance} m in {now - since:.0f} s"
