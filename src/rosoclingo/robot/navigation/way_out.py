"""The escape manoeuvre of a robot with a footprint where it cannot turn: along one arc to where it can."""

import math
from typing import Optional

import numpy as np

from rosoclingo.robot.navigation.body import Body, Situation
from rosoclingo.robot.navigation.compiled.rollout import best_arc
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.local_planner import Velocity

__all__ = ["WayOut"]

CURVATURES = np.array(
    [0.0, *(sign * c for c in (0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.6, 1.0, 1.7, 3.0) for sign in (1, -1))]
)  # 1/m
FLOORS = (0.005, 0.002, 0.0005)  # m that an arc keeps free: the first by which one leads anywhere
LONGEST = 3.0  # m
SPARE = 0.01  # m more than it needs to turn
END = 0.01  # m that may be left of an arc
SLACK, SLOWEST = 0.0005, 0.02  # m that is lost on the way; m/s
TIME = 0.8  # s in which the rest of an arc is driven at least


class WayOut:
    """Finds an arc, forwards or backwards, and drives it; ``speed`` in m/s."""

    def __init__(self, speed: float) -> None:
        self._speed = speed
        self._curvature, self._left, self._floor = 0.0, 0.0, 0.0  # 1/m, m (signed), m
        self._at: Optional[Pose2D] = None  # where the robot was last on the arc

    def begin(self, body: Body, now: Situation) -> Optional[Velocity]:
        """Return what to drive along the arc that leads out best, None where none does."""
        return self._kept(now, self._on(body, now) if self._find(body, now) else None)

    def go_on(self, body: Body, now: Situation) -> Optional[Velocity]:
        """Return what to drive to the end of the arc begun; None at its end, or where it is not clear any more."""
        if self._at is None:
            return None
        self._left -= math.copysign(min(abs(self._left), self._at.distance(now.pose)), self._left)
        return self._kept(now, self._on(body, now) if abs(self._left) > END else None)

    def end(self) -> None:
        """Leave the arc."""
        self._at = None

    def _kept(self, now: Situation, velocity: Optional[Velocity]) -> Optional[Velocity]:
        self._at = None if velocity is None else now.pose
        return velocity

    def _find(self, body: Body, now: Situation) -> bool:
        """Look for the arc; tell whether there is one."""
        scale = now.costmap.resolution
        room = (body.outer + SPARE) / scale
        for floor in FLOORS:
            i, length = best_arc(
                now.around,
                body.pieces(scale),
                np.array(now.cells),
                CURVATURES * scale,
                LONGEST / scale,
                room,
                floor / scale,
            )
            if length != 0.0:
                self._curvature, self._left, self._floor = float(CURVATURES[i]), length * scale, floor
                return True
        return False

    def _on(self, body: Body, now: Situation) -> Optional[Velocity]:
        """Return the velocity on along the arc, None where that is not clear."""
        speed = math.copysign(min(self._speed, max(SLOWEST, abs(self._left) / TIME)), self._left)
        velocity = Velocity(speed, speed * self._curvature)
        least = min(self._floor, body.spare(now, self._floor)) - SLACK
        return velocity if body.is_clear(now, velocity, least) else None
