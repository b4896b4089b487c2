"""The robot's body, and collision checks of its movements on a costmap."""

import math
from typing import Optional, Sequence, Union

import numpy as np

from rosoclingo.robot.navigation.compiled.rollout import best_command, can_turn
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D, normalize_angle
from rosoclingo.robot.navigation.local_planner import Velocity, inscribed_radius

Point = Union[Sequence[float], np.ndarray]  # x, y (m)

TURN_CLEARANCE = 0.005  # m: clearance of the corners during a turn, to allow for the delay of commands


class Body:
    """The shape of a robot: a disc of ``radius`` m, or a ``footprint`` polygon of corners (x, y) in m.

    The corners are in the robot's frame. ``inner`` is the radius (m) of the inscribed circle around the robot's origin,
    ``outer`` that of the circumscribed circle.
    """

    def __init__(self, radius: float, footprint: Sequence = ()) -> None:
        self.radius, self.footprint = radius, tuple(footprint)
        self.inner = inscribed_radius(radius, self.footprint)
        self.outer = max((math.hypot(*corner) for corner in self.footprint), default=radius)


class BodyState:
    """A body on a costmap, with its pose (m, rad), velocity and control period (s)."""

    def __init__(self, body: Body, costmap: Costmap, pose: Pose2D, velocity: Velocity, period: float) -> None:
        self.body, self.costmap, self.pose, self.velocity, self.period = body, costmap, pose, velocity, period
        self._scale = 1.0 / costmap.resolution
        outline = np.array(body.footprint, dtype=np.float64).reshape(-1, 2) * self._scale
        self._shape = (outline, body.radius * self._scale, body.outer * self._scale)
        self._cells = np.array([*costmap.to_cells(pose.x, pose.y), pose.yaw])
        self._obstacles = (costmap.clearance, costmap.occupied)

    def bearing(self, point: Point) -> float:
        """Return the angle (rad) between the robot's heading and the direction to a point."""
        return normalize_angle(math.atan2(point[1] - self.pose.y, point[0] - self.pose.x) - self.pose.yaw)

    def distance(self, point: Point) -> float:
        """Return the distance (m) to a point."""
        return math.hypot(point[0] - self.pose.x, point[1] - self.pose.y)

    def can_turn(self, angle: float) -> bool:
        """Return whether the robot can turn on the spot by ``angle`` rad.

        Its clearance must stay at least TURN_CLEARANCE, or at least its present clearance if that is smaller.
        """
        if not self.body.footprint:
            return True
        return bool(can_turn(*self._obstacles, self._shape, self._cells, angle, TURN_CLEARANCE * self._scale))

    def best_command(
        self,
        speeds: np.ndarray,
        needs: np.ndarray,
        turns: np.ndarray,
        carrot: Point,
        comfort: float,
        horizon: float,
    ) -> Optional[Velocity]:
        """Return the safe command with the best score towards a point (m), or None.

        Candidates are all pairs of ``speeds`` (m/s) and ``turns`` (rad/s). For the scores see
        :func:`~rosoclingo.robot.navigation.compiled.rollout.best_command`; all lengths are in m.
        """  # fmt: skip
        scale, cells = self._scale, np.array(self.costmap.to_cells(*carrot))
        i, j = best_command(
            *self._obstacles, self._shape, self._cells, speeds * scale, needs * scale, turns, cells, comfort * scale,
            horizon, self.costmap.resolution,
        )  # fmt: skip
        return Velocity(float(speeds[i]), float(turns[j])) if i >= 0 else None
