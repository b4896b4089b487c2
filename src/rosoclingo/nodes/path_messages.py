"""Paths as messages: their poses are kept as an array and written at once.

What is sent is the same, but to make and to write each pose as an object of its own takes far longer.
"""

import struct
from typing import Any

import numpy as np
import rospy
from nav_msgs.msg import Path
from nav_msgs.srv import GetPlanResponse

__all__ = ["PlanResponse", "PointsPath", "path_message"]


class PointsPath(Path):  # type: ignore[misc]
    """A path of ``places``, a float64 array (n, 3) of x, y (m), yaw (rad); its ``poses`` are not used."""

    def __init__(self, places: np.ndarray, frame: str, stamp: rospy.Time) -> None:
        super().__init__()
        self.places, self.header.frame_id, self.header.stamp = places, frame, stamp

    def serialize(self, buff: Any) -> None:
        """Write the message, as genpy would write its poses."""
        header, frame = self.header, self.header.frame_id.encode()
        start = struct.pack("<4I", header.seq, header.stamp.secs, header.stamp.nsecs, len(frame)) + frame
        kind = np.dtype([("header", f"V{len(start)}"), ("pose", "<f8", 7)])
        poses = np.zeros(len(self.places), dtype=kind)
        poses["header"] = np.void(start)
        poses["pose"][:, :2] = self.places[:, :2]
        poses["pose"][:, 5], poses["pose"][:, 6] = np.sin(0.5 * self.places[:, 2]), np.cos(0.5 * self.places[:, 2])
        buff.write(start + struct.pack("<I", len(poses)))
        buff.write(poses.tobytes())


class PlanResponse(GetPlanResponse):  # type: ignore[misc]
    """The answer of a service that plans, with a :class:`PointsPath`."""

    def serialize(self, buff: Any) -> None:
        """Write the message, which is the path alone."""
        self.plan.serialize(buff)


def path_message(points: np.ndarray, frame: str, stamp: rospy.Time, final_yaw: float = 0.0) -> PointsPath:
    """Return points (n, 2; m) as a path; each pose looks to the next, the last one to ``final_yaw``."""
    places = np.empty((len(points), 3))
    places[:, :2] = points
    if len(points):
        steps = np.diff(points, axis=0)
        places[:-1, 2], places[-1, 2] = np.arctan2(steps[:, 1], steps[:, 0]), final_yaw
    return PointsPath(places, frame, stamp)
