"""Counts collisions of a robot from data of any simulator: its commands and its true poses."""

from typing import Optional, Tuple

__all__ = ["Stalls"]

MOVES = 0.02, 0.05  # m/s, rad/s: larger commands move the robot
STILL = 1e-6  # m, rad: smaller changes of the pose are no motion
FRESH = 0.15  # s: the watchdog has cancelled older commands
TIMES = 3  # number of poses without motion that count as a collision


class Stalls:
    """Counts the ``times`` that a robot stands still despite its commands: Stage stops it before it collides."""

    def __init__(self) -> None:
        self.times = 0
        self._command: Tuple[float, float, float] = (-1.0, 0.0, 0.0)
        self._pose: Optional[Tuple[float, float, float]] = None
        self._still = 0

    def command(self, now: float, linear: float, angular: float) -> None:
        """Record a command (m/s, rad/s) at the time ``now`` (s)."""
        self._command = (now, linear, angular)

    def truth(self, now: float, x: float, y: float, yaw: float) -> None:
        """Record the true pose (m, rad) at the time ``now`` (s)."""
        at, linear, angular = self._command
        moves = abs(linear) > MOVES[0] or abs(angular) > MOVES[1]
        stands = self._pose is not None and max(abs(a - b) for a, b in zip(self._pose, (x, y, yaw))) < STILL
        self._still = self._still + 1 if moves and stands and 0.0 <= now - at <= FRESH else 0
        self.times += self._still == TIMES
        self._pose = (x, y, yaw)
