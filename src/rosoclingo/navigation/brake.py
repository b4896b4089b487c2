"""Braking for what the laser sees just now and no costmap has yet: it takes several scans for a cell to be marked.

What moves is never marked in time: another robot that comes along is in each cell for a scan or two.
"""

import math
from typing import Sequence

import numpy as np

from rosoclingo.navigation.geometry import Pose2D
from rosoclingo.navigation.local_planner import Velocity

__all__ = ["braked"]

MARGIN = 0.05  # m kept free
TIMES = np.linspace(0.2, 1.0, 5)  # s ahead; that what is seen may come nearer by itself is in it
PARTS = (1.0, 0.6, 0.3)  # of the speed, tried in turn


def braked(velocity: Velocity, pose: Pose2D, points: np.ndarray, radius: float, footprint: Sequence = ()) -> Velocity:
    """Return a velocity, or a slower one that leads a robot (m) no nearer to points (n, 2; m) than it may.

    Where there is none, a disc may turn on the spot; any other footprint stands still.
    """
    if not len(points) or velocity.linear == 0.0:
        return velocity
    reach = max((math.hypot(*corner) for corner in footprint), default=radius) + MARGIN
    now = _nearest(pose, points)
    for part in PARTS:
        ahead = (pose.moved(part * velocity.linear, velocity.angular, float(time)) for time in TIMES)
        if all(distance >= min(reach, now + 1e-6) for distance in (_nearest(place, points) for place in ahead)):
            return Velocity(part * velocity.linear, velocity.angular)
    return Velocity(0.0, 0.0 if len(footprint) else velocity.angular)


def _nearest(pose: Pose2D, points: np.ndarray) -> float:
    return float(np.hypot(points[:, 0] - pose.x, points[:, 1] - pose.y).min())
