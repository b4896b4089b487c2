"""Driving through tight places: along the path in straight legs, turning on the spot between them.

Arcs cannot be tried finely enough where only millimetres are free; a straight leg can be looked at exactly.
"""

import math
from typing import Optional

import numpy as np

from rosoclingo.navigation.body import Body, Situation
from rosoclingo.navigation.compiled_rollout import furthest_leg, spare_after
from rosoclingo.navigation.local_planner import STOP, Velocity

__all__ = ["Squeeze"]

FLOORS = np.array([0.02, 0.01, 0.005, 0.002, 0.0005])  # m that a leg keeps free: the first that is possible
SLACK = 0.0005  # m that a movement may come nearer than its leg
AHEAD = 0.8  # s for which a movement has to be clear; also what is left of a leg is driven in no less
FACING = 0.02  # rad: within it the robot goes on without another look
SLOWEST = 0.02  # m/s
STEPS = 8  # places looked at along a movement
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
            body.discs(costmap.resolution),
            np.array(now.cells),
            costmap.all_to_cells(points),
            FLOORS / costmap.resolution,
        )
        if i < 0:
            return None
        most = body.slow_turn(self._speed, self._rate)
        fastest = min(self._speed, max(SLOWEST, now.distance(points[i]) / AHEAD))
        if abs(turn) < 0.5 * math.pi:
            for part in PARTS:
                velocity = Velocity(max(SLOWEST, part * fastest), _clipped(self._gain * turn, most))
                if self._is_clear(body, now, velocity, spare * costmap.resolution - SLACK):
                    return velocity
        if abs(turn) <= FACING:
            return Velocity(SLOWEST, _clipped(self._gain * turn, most))
        if abs(now.velocity.linear) > 0.05:
            return STOP
        return Velocity(0.0, _clipped(math.copysign(self._gain * abs(turn) + 0.03, turn), most))

    @staticmethod
    def _is_clear(body: Body, now: Situation, velocity: Velocity, least: float) -> bool:
        scale = 1.0 / now.costmap.resolution
        found = spare_after(
            now.around, body.discs(now.costmap.resolution), *now.cells,
            velocity.linear * scale, velocity.angular, AHEAD, STEPS, least * scale, least * scale,
        )  # fmt: skip
        return bool(found >= least * scale)


def _clipped(rate: float, most: float) -> float:
    return max(-most, min(most, rate))
