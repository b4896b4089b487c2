"""Planar poses: metres and radians, x forward, y left, yaw counter-clockwise (REP 103)."""

import math
from typing import NamedTuple, Optional, Tuple


def normalize_angle(angle: float) -> float:
    """Return the equivalent angle (rad) in [-pi, pi]."""
    return math.remainder(angle, 2.0 * math.pi)


class Pose2D(NamedTuple):
    """A pose (or a transform) in the plane: ``x``, ``y`` in m, ``yaw`` in rad."""

    x: float
    y: float
    yaw: float = 0.0

    def compose(self, other: "Pose2D") -> "Pose2D":
        """Transform ``other`` from the frame of this pose to the parent frame."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(
            self.x + c * other.x - s * other.y,
            self.y + s * other.x + c * other.y,
            normalize_angle(self.yaw + other.yaw),
        )

    def inverse(self) -> "Pose2D":
        """Return the inverse transform."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return Pose2D(-c * self.x - s * self.y, s * self.x - c * self.y, -self.yaw)

    def distance(self, other: "Pose2D") -> float:
        """Return the distance (m) between the positions of two poses."""
        return math.hypot(self.x - other.x, self.y - other.y)

    def interpolate(self, other: "Pose2D", part: float) -> "Pose2D":
        """Interpolate towards another pose: ``part`` 0 is this pose, 1 the other."""
        turn = normalize_angle(other.yaw - self.yaw)
        return Pose2D(
            self.x + part * (other.x - self.x),
            self.y + part * (other.y - self.y),
            normalize_angle(self.yaw + part * turn),
        )

    def advance(self, v: float, w: float, dt: float) -> "Pose2D":
        """Return the pose after ``dt`` s at ``v`` m/s and ``w`` rad/s, on the exact arc of a differential drive."""
        half = 0.5 * w * dt
        # Chord of an arc of length v*dt; the series of sin(x)/x is used for (nearly) straight lines.
        chord = v * dt * (math.sin(half) / half if abs(half) > 1e-9 else 1.0 - half * half / 6.0)
        direction = self.yaw + half
        return Pose2D(
            self.x + chord * math.cos(direction),
            self.y + chord * math.sin(direction),
            normalize_angle(self.yaw + w * dt),
        )


def yaw_to_quaternion(yaw: float) -> Tuple[float, float, float, float]:
    """Return the quaternion (x, y, z, w) of a rotation by ``yaw`` about the z axis."""
    return 0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)


def quaternion_to_yaw(x: float, y: float, z: float, w: float, tilt: float = 1e-3) -> Optional[float]:
    """Return the yaw of a quaternion, or None if it is not a rotation about the z axis.

    Rejects the same quaternions as move_base: those that are not finite or close to zero, and those whose z axis is
    tilted by more than ``tilt`` (1 - cosine).
    """
    norm2 = x * x + y * y + z * z + w * w
    if not math.isfinite(norm2) or norm2 < 1e-6:
        return None
    if 2.0 * (x * x + y * y) / norm2 > tilt:
        return None
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)
