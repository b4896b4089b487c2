"""Braking for what the laser sees just now and no costmap has yet: it takes several scans for a cell to be marked.

What moves is never marked in time: another robot that comes along is in each cell for a scan or two.
"""

import math
from typing import Sequence

import numpy as np

from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.local_planner import Velocity

__all__ = ["braked"]

MARGIN, BESIDE = 0.05, 0.02  # m kept free ahead, and beside a robot that turns on the spot
TIMES = np.linspace(0.2, 1.0, 5)  # s ahead; that what is seen may come nearer by itself is in it
SOON = np.linspace(0.05, 0.4, 8)  # s ahead that corners are looked after: a turn stops at once
PARTS = (1.0, 0.6, 0.3)  # of the speed, tried in turn


def braked(velocity: Velocity, pose: Pose2D, points: np.ndarray, radius: float, footprint: Sequence = ()) -> Velocity:
    """Return a velocity, or a slower one that leads a robot (m) no nearer to points (n, 2; m) than it may.

    Where there is none, a disc may turn on the spot; any other footprint stands still, as it does before it sweeps over
    a point.
    """
    if not len(points):
        return velocity
    slow = velocity if velocity.linear == 0.0 else _slowed(velocity, pose, points, radius, footprint)
    return Velocity() if len(footprint) and _sweeps(slow, pose, points, footprint) else slow


def _slowed(velocity: Velocity, pose: Pose2D, points: np.ndarray, radius: float, footprint: Sequence) -> Velocity:
    reach = max((math.hypot(*corner) for corner in footprint), default=radius) + MARGIN
    now = _nearest(pose, points)
    for part in PARTS:
        ahead = (pose.moved(part * velocity.linear, velocity.angular, float(time)) for time in TIMES)
        if all(distance >= min(reach, now + 1e-6) for distance in (_nearest(place, points) for place in ahead)):
            return Velocity(part * velocity.linear, velocity.angular)
    return Velocity(0.0, 0.0 if len(footprint) else velocity.angular)


def _nearest(pose: Pose2D, points: np.ndarray) -> float:
    return float(np.hypot(points[:, 0] - pose.x, points[:, 1] - pose.y).min())


def _sweeps(velocity: Velocity, pose: Pose2D, points: np.ndarray, footprint: Sequence) -> bool:
    """Tell whether a movement leads a footprint (m) over or next to a point (n, 2; m) that it is not over."""
    now = _depths(pose, points, footprint)
    most = np.where(now < 0.0, np.maximum(now, -BESIDE), np.inf) + 1e-6
    ahead = (pose.moved(*velocity, float(time)) for time in SOON)
    return any((_depths(place, points, footprint) > most).any() for place in ahead)


def _depths(pose: Pose2D, points: np.ndarray, footprint: Sequence) -> np.ndarray:
    """Return how deep (m), seen from its origin, points are in a footprint; less than 0 outside."""
    dx, dy = (points - (pose.x, pose.y)).T
    return _extent(footprint, np.arctan2(dy, dx) - pose.yaw) - np.hypot(dx, dy)


def _extent(footprint: Sequence, bearings: np.ndarray) -> np.ndarray:
    """Return how far (m) a footprint reaches from its origin in each of the directions (rad) in its frame."""
    x, y = np.array(footprint).T
    ex, ey = np.roll(x, -1) - x, np.roll(y, -1) - y
    dx, dy = np.cos(bearings)[:, None], np.sin(bearings)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        across = dx * ey - dy * ex
        away, part = (x * ey - y * ex) / across, (x * dy - y * dx) / across
    return np.where((part >= 0.0) & (part <= 1.0) & (away > 0.0), away, 0.0).max(axis=1)
