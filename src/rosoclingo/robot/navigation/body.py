"""The robot's body, as the compiled trials take it, and what it is tried in."""

import math
from typing import NamedTuple, Sequence, Tuple

import numpy as np

from rosoclingo.robot.navigation.compiled.footprints import Around, around, body_clearance
from rosoclingo.robot.navigation.compiled.rollout import spare_after, turn_spare
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D, normalize_angle
from rosoclingo.robot.navigation.local_planner import Velocity, inscribed_radius

__all__ = ["Body", "Situation", "Trial"]

CLEAR = 0.005  # m that corners keep free in a turn, as commands come late
FINEST = 0.0125  # m: the shortest pieces of an edge
# In a tight place a movement has to be clear for AHEAD (s), in which STEPS places are looked at.
AHEAD, STEPS = 0.8, 8


class Situation(NamedTuple):
    """What a command is found for: the map, the robot's pose and velocity, and for how long (s); what it touches."""

    costmap: Costmap
    pose: Pose2D
    velocity: Velocity
    period: float
    around: Around

    def bearing(self, point: Sequence[float]) -> float:
        """Return the angle (rad) by which the robot would have to turn to face a point."""
        return normalize_angle(math.atan2(point[1] - self.pose.y, point[0] - self.pose.x) - self.pose.yaw)

    def eased(self, rate: float, acceleration: float) -> float:
        """Return a turn (rad/s), but no faster than an acceleration (rad/s2) allows; slower it may be at once."""
        before = self.velocity.angular if self.velocity.angular * rate > 0.0 else 0.0
        return math.copysign(min(abs(rate), abs(before) + acceleration * self.period), rate)

    def distance(self, point: Sequence[float]) -> float:
        """Return the distance (m) to a point."""
        return math.hypot(point[0] - self.pose.x, point[1] - self.pose.y)

    @property
    def cells(self) -> Tuple[float, float, float]:
        """The pose (x, y in cells, yaw in rad)."""
        return (*self.costmap.to_cells(self.pose.x, self.pose.y), self.pose.yaw)


class Trial(NamedTuple):
    """Which commands to try: speeds (m/s), the room (m) each needs, the fastest turn (rad/s).

    ``weights``, ``comfort``: see :func:`~rosoclingo.robot.navigation.compiled.rollout.best_command`.
    """

    speeds: np.ndarray
    needs: np.ndarray
    comfort: float
    weights: Tuple[float, float, float]
    rate: float


class Body:
    """A disc of ``radius`` m or a footprint, a sequence of corners (x, y) in m in the robot's frame.

    ``inner``, ``outer``: radii (m) of the circles around the robot's origin that are within it and that it is within.
    """

    def __init__(self, radius: float, footprint: Sequence = ()) -> None:
        self.radius, self.footprint = radius, tuple(footprint)
        self.inner = inscribed_radius(radius, self.footprint)
        self.outer = max((math.hypot(*corner) for corner in self.footprint), default=radius)
        self._pieces: Tuple[float, np.ndarray] = (0.0, np.empty((0, 5)))

    def pieces(self, resolution: float) -> np.ndarray:
        """Return what stands for the body on a grid, see :mod:`~rosoclingo.robot.navigation.compiled.footprints`."""
        if self._pieces[0] != resolution:
            self._pieces = (resolution, self._made(resolution))
        return self._pieces[1]

    def _made(self, resolution: float) -> np.ndarray:
        pieces = [(0.0, 0.0, self.outer, 0.0, 0.0)]
        corners = [np.array(corner, dtype=np.float64) for corner in self.footprint]
        for a, b in zip(corners, corners[1:] + corners[:1]):
            length = math.hypot(*(b - a))
            count = max(1, math.ceil(length / max(0.25 * resolution, FINEST)))
            ahead = (b - a) / length if length > 0.0 else np.zeros(2)
            pieces += [(*(a + (b - a) * ((i + 0.5) / count)), 0.5 * length / count, *ahead) for i in range(count)]
        return np.array(pieces) / (resolution, resolution, resolution, 1.0, 1.0)

    def slow_turn(self, speed: float, most: float) -> float:
        """Return the turn (rad/s; ``most`` at most) that moves no corner faster than a speed (m/s); a disc has none."""
        return min(most, speed / self.outer) if self.footprint else most

    def situation(self, costmap: Costmap, pose: Pose2D, velocity: Velocity, period: float) -> Situation:
        """Return what a command is found for, with what the body touches there."""
        pieces, cells = self.pieces(costmap.resolution), (*costmap.to_cells(pose.x, pose.y), pose.yaw)
        return Situation(costmap, pose, velocity, period, around(costmap.clearance, costmap.occupied, pieces, *cells))

    def spare(self, now: Situation, enough: float) -> float:
        """Return how far (m) the body is from what is nearest; may be less where more than ``enough`` is certain."""
        scale = now.costmap.resolution
        return float(body_clearance(now.around, self.pieces(scale), *now.cells, enough / scale)) * scale

    def is_clear(self, now: Situation, velocity: Velocity, least: float) -> bool:
        """Tell whether the body keeps ``least`` m for a moment in which it is driven in a tight place."""
        scale = 1.0 / now.costmap.resolution
        found = spare_after(
            now.around, self.pieces(now.costmap.resolution), *now.cells,
            velocity.linear * scale, velocity.angular, AHEAD, STEPS, least * scale, least * scale,
        )  # fmt: skip
        return bool(found >= least * scale)

    def may_turn(self, now: Situation, angle: float) -> bool:
        """Tell whether the body keeps CLEAR, or what it has now if that is less, while it turns by ``angle`` rad."""
        if not self.footprint:
            return True
        pieces, cells = self.pieces(now.costmap.resolution), now.cells
        close = CLEAR / now.costmap.resolution
        least = min(close, body_clearance(now.around, pieces, *cells, close) - 1e-3)
        return bool(turn_spare(now.around, pieces, *cells, angle, least) >= least)
