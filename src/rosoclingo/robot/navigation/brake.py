"""Braking for obstacles that the laser sees but the costmap does not contain yet.

Marking a cell takes several scans. Moving obstacles, such as another robot, leave a cell before it is marked.
"""

import math
from typing import Sequence

import numpy as np

from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.local_planner import Velocity

# While driving: times to check (s) and the margin (m), which allows for approaching obstacles.
DRIVE_TIMES, DRIVE_MARGIN = np.linspace(0.2, 1.0, 5), 0.05
# While turning on the spot, where the robot can stop at once: times to check (s) and the margin (m).
TURN_TIMES, TURN_MARGIN = np.linspace(0.05, 0.4, 8), 0.02
SPEED_FACTORS = (1.0, 0.6, 0.3, 0.0)  # fractions of the speed, tried in this order


def brake(velocity: Velocity, pose: Pose2D, points: np.ndarray, radius: float, footprint: Sequence = ()) -> Velocity:
    """Return the velocity, reduced where necessary to keep a margin to nearby points (n, 2; m).

    If the robot is within the margin of a point already, the distance must not decrease. If no candidate is safe, the
    robot stops.
    """
    if not len(points):
        return velocity
    now = _gaps(pose, points, radius, footprint)
    for part in SPEED_FACTORS:
        slower = Velocity(part * velocity.linear, velocity.angular)
        checks = [(TURN_TIMES, TURN_MARGIN), *([(DRIVE_TIMES, DRIVE_MARGIN)] if slower.linear else [])]
        if all(
            (
                _gaps(pose.advance(*slower, float(time)), points, radius, footprint) >= np.minimum(margin, now) - 1e-6
            ).all()
            for times, margin in checks
            for time in times
        ):
            return slower
    return Velocity()


def _gaps(pose: Pose2D, points: np.ndarray, radius: float, footprint: Sequence) -> np.ndarray:
    """Return the distances (m) of points from the robot's edge at a pose; negative inside the robot."""
    x, y = (points - pose[:2]).T
    if not len(footprint):
        return np.hypot(x, y) - radius
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    at = np.stack((c * x + s * y, c * y - s * x), axis=1)[:, None]
    corners = np.array(footprint, dtype=np.float64)
    ends = np.roll(corners, -1, axis=0)
    edges, away = ends - corners, at - corners
    part = np.clip((away * edges).sum(axis=2) / (edges**2).sum(axis=1), 0.0, 1.0)
    gaps = np.hypot(*np.moveaxis(away - part[..., None] * edges, 2, 0)).min(axis=1)
    between = (corners[:, 1] > at[..., 1]) != (ends[:, 1] > at[..., 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        left = away[..., 0] < away[..., 1] * edges[:, 0] / edges[:, 1]
    inside = (between & left).sum(axis=1) % 2 == 1
    return np.where(inside, -gaps, gaps)
