"""Where the robot came from, to go back that way."""

from collections import deque
from typing import Deque, Optional, Tuple

from rosoclingo.robot.navigation.geometry import Pose2D

__all__ = ["Trail"]

STEP = 0.05  # m between the places that are kept
AWAY = 0.15  # m: what is nearer is no place to go back to
COUNT = 60  # places kept, of the last 3 m


class Trail:
    """The last places at which the robot was: what led in leads out."""

    def __init__(self) -> None:
        self._places: Deque[Pose2D] = deque(maxlen=COUNT)

    def note(self, pose: Pose2D) -> None:
        """Keep a pose, if it is away from the one before."""
        if not self._places or self._places[-1].distance(pose) >= STEP:
            self._places.append(pose)

    def back(self, pose: Pose2D) -> Optional[Tuple[float, float]]:
        """Return the next place (m) to go back to from a pose, None where there is none; forgets those passed."""
        while self._places and self._places[-1].distance(pose) < AWAY:
            self._places.pop()
        return self._places[-1][:2] if self._places and self._places[-1].distance(pose) < 2.0 * AWAY else None
