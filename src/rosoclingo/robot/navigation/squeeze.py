"""Driving through tight places: along the path in straight legs, turning on the spot between them.

Arcs cannot be tried finely enough where only millimetres are free; a straight leg can be looked at exactly.
"""

import math
from typing import Optional

import numpy as np

from rosoclingo.robot.navigation.body import SLACK, SLOWEST, Body, Situation, creeping
from rosoclingo.robot.navigation.compiled.rollout import furthest_leg
from rosoclingo.robot.navigation.local_planner import STOP, Velocity

__all__ = ["Squeeze"]

# m that a leg keeps free: the first that is possible. Corners swing out where commands come late, a disc does not.
FLOORS, CORNER_FLOORS = np.array([0.02, 0.01, 0.005, 0.002, 0.0005]), np.array([0.02, 0.01, 0.007, 0.004])
FACING = 0.02  # rad: within it the robot goes on without another look
PARTS = (1.0, 0.5, 0.25)  # of the speed, tried in turn


class Squeeze:
    """Finds the furthest point of a path that a straight leg leads to, turns to it and drives there.

    ``speed`` (m/s), ``rate`` (rad/s): the most; ``gain`` (1/s): a turn is slower towards its end. Turns begin at once,
    as a leg would be bent by one that has to get faster first.
    """

    def __init__(self, speed: float, rate: float, gain: float) -> None:
        self._speed, self._rate, self._gain = speed, rate, gain

    def command(self, body: Body, now: Situation, points: np.ndarray) -> Optional[Velocity]:
        """Return what to drive to get on along points (float64 n, 2; m), None where no leg leads to any of them."""
        costmap = now.costmap
        i, turn, spare = furthest_leg(
            now.around,
            body.pieces(costmap.resolution),
            np.array(now.cells),
            costmap.all_to_cells(points),
            (CORNER_FLOORS if body.footprint else FLOORS) / costmap.resolution,
        )
        if i < 0:
            return None
        most = body.slow_turn(self._speed, self._rate)
        fastest = creeping(now.distance(points[i]), self._speed)
        if abs(turn) < 0.5 * math.pi:
            for part in PARTS:
                velocity = Velocity(max(SLOWEST, part * fastest), _clipped(self._gain * turn, most))
                if body.is_clear(now, velocity, spare * costmap.resolution - SLACK):
                    return velocity
        if abs(turn) <= FACING:
            return Velocity(SLOWEST, _clipped(self._gain * turn, most))
        if abs(now.velocity.linear) > 0.05:
            return STOP
        return Velocity(0.0, _clipped(math.copysign(self._gain * abs(turn) + 0.03, turn), most))


def _clipped(rate: float, most: float) -> float:
    return max(-most, min(most, rate))
