"""Paths and polygons as messages: their points are kept as an array and written at once.

What is sent is the same, but to make and to write each point as an object of its own takes far longer.
"""

import struct
from typing import Any

import numpy as np
import rospy
from geometry_msgs.msg import PolygonStamped
from nav_msgs.msg import Path
from nav_msgs.srv import GetPlanResponse
from std_msgs.msg import Header

__all__ = ["PlanResponse", "PointsPath", "PointsPolygon", "path_message"]


class PointsPath(Path):  # type: ignore[misc]
    """A path of ``places``, a float64 array (n, 3) of x, y (m), yaw (rad); its ``poses`` are not used."""

    def __init__(self, places: np.ndarray, frame: str, stamp: rospy.Time) -> None:
        super().__init__()
        self.places, self.header.frame_id, self.header.stamp = places, frame, stamp

    def serialize(self, buff: Any) -> None:
        """Write the message, as genpy would write its poses."""
        start = _written(self.header)
        poses = np.zeros((len(self.places), 7), dtype="<f8")
        poses[:, :2] = self.places[:, :2]
        half = 0.5 * self.places[:, 2]
        poses[:, 5], poses[:, 6] = np.sin(half), np.cos(half)
        rows = np.empty((len(poses), len(start) + 56), dtype=np.uint8)
        rows[:, : len(start)] = np.frombuffer(start, dtype=np.uint8)
        rows[:, len(start) :] = poses.view(np.uint8)
        buff.write(start + struct.pack("<I", len(poses)))
        buff.write(rows.tobytes())


class PointsPolygon(PolygonStamped):  # type: ignore[misc]
    """A polygon of ``corners``, an array (n, 2) of x, y (m); its ``polygon`` is not used."""

    def __init__(self, corners: np.ndarray, frame: str, stamp: rospy.Time) -> None:
        super().__init__()
        self.corners, self.header.frame_id, self.header.stamp = corners, frame, stamp

    def serialize(self, buff: Any) -> None:
        """Write the message, as genpy would write its points."""
        points = np.zeros((len(self.corners), 3), dtype="<f4")
        points[:, :2] = self.corners
        buff.write(_written(self.header) + struct.pack("<I", len(points)) + points.tobytes())


class PlanResponse(GetPlanResponse):  # type: ignore[misc]
    """The answer of a service that plans, with a :class:`PointsPath`."""

    def serialize(self, buff: Any) -> None:
        """Write the message, which is the path alone."""
        self.plan.serialize(buff)


def _written(header: Header) -> bytes:
    frame = header.frame_id.encode()
    return struct.pack("<4I", header.seq, header.stamp.secs, header.stamp.nsecs, len(frame)) + frame


def path_message(points: np.ndarray, frame: str, stamp: rospy.Time, final_yaw: float = 0.0) -> PointsPath:
    """Return points (n, 2; m) as a path; each pose looks to the next, the last one to ``final_yaw``."""
    places = np.empty((len(points), 3))
    places[:, :2] = points
    if len(points):
        steps = places[1:, :2] - places[:-1, :2]
        places[:-1, 2], places[-1, 2] = np.arctan2(steps[:, 1], steps[:, 0]), final_yaw
    return PointsPath(places, frame, stamp)
