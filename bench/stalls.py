"""Counts where a robot runs into something, by what any simulator tells: its commands, and where it truly is."""

from typing import Optional, Tuple

__all__ = ["Stalls"]

MOVES = 0.02, 0.05  # m/s, rad/s: a command that moves the robot
STILL = 1e-6  # m, rad
FRESH = 0.15  # s: an older command has been taken back by the watchdog
TIMES = 3  # truths in which it must stand


class Stalls:
    """Counts ``times`` that a robot stands still though it is commanded to move: Stage stops it before it touches."""

    def __init__(self) -> None:
        self.times = 0
        self._command: Tuple[float, float, float] = (-1.0, 0.0, 0.0)
        self._pose: Optional[Tuple[float, float, float]] = None
        self._still = 0

    def command(self, now: float, linear: float, angular: float) -> None:
        """Take a command (m/s, rad/s) given at a time (s)."""
        self._command = (now, linear, angular)

    def truth(self, now: float, x: float, y: float, yaw: float) -> None:
        """Take a pose (m, rad) at a time (s)."""
        at, linear, angular = self._command
        moves = abs(linear) > MOVES[0] or abs(angular) > MOVES[1]
        stands = self._pose is not None and max(abs(a - b) for a, b in zip(self._pose, (x, y, yaw))) < STILL
        self._still = self._still + 1 if moves and stands and 0.0 <= now - at <= FRESH else 0
        self.times += self._still == TIMES
        self._pose = (x, y, yaw)
