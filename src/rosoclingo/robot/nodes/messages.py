"""Conversion between ROS messages and the plain values of navigation and simulation."""

import math
from typing import Any, Optional

import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid as OccupancyGridMessage
from nav_msgs.msg import Path
from rospy.numpy_msg import numpy_msg

from rosoclingo.robot.navigation.geometry import Pose2D, quaternion_to_yaw, yaw_to_quaternion
from rosoclingo.robot.navigation.grid import MapError, OccupancyGrid

GRID_MESSAGE = numpy_msg(OccupancyGridMessage)  # serialises arrays; element by element, a large map takes seconds


class _Sendable(np.ndarray):
    """Array with ``tostring``, which generated messages call and numpy 2.3 has removed."""

    def tostring(self, order: str = "C") -> bytes:  # type: ignore[override]
        """Return the array's bytes."""
        return self.tobytes(order)  # type: ignore[arg-type]


def sendable(array: np.ndarray) -> np.ndarray:
    """Return a view of an array that messages of rospy.numpy_msg can contain."""
    return array.view(_Sendable)


def to_pose2d(pose: Any) -> Optional[Pose2D]:
    """Convert a geometry_msgs/Pose to the plane; None if its orientation is not a rotation about the z axis."""
    yaw = quaternion_to_yaw(pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w)
    return None if yaw is None else Pose2D(pose.position.x, pose.position.y, yaw)


def from_transform(transform: Any) -> Pose2D:
    """Convert a geometry_msgs/Transform to the plane; the yaw is 0 if its rotation is not about the z axis."""
    rotation = transform.rotation
    yaw = quaternion_to_yaw(rotation.x, rotation.y, rotation.z, rotation.w)
    return Pose2D(transform.translation.x, transform.translation.y, yaw or 0.0)


def fill_pose(message: Any, pose: Pose2D) -> None:
    """Write a pose into a geometry_msgs/Pose."""
    message.position.x, message.position.y = pose.x, pose.y
    _, _, message.orientation.z, message.orientation.w = yaw_to_quaternion(pose.yaw)


def fill_transform(message: Any, pose: Pose2D) -> None:
    """Write a pose into a geometry_msgs/Transform."""
    message.translation.x, message.translation.y = pose.x, pose.y
    _, _, message.rotation.z, message.rotation.w = yaw_to_quaternion(pose.yaw)


def stamped_pose(pose: Pose2D, frame: str) -> PoseStamped:
    """Return a pose (m, rad) in a frame as a message with the present time."""
    message = PoseStamped()
    message.header.frame_id, message.header.stamp = frame, rospy.Time.now()
    fill_pose(message.pose, pose)
    return message


def path_message(points: np.ndarray, frame: str, final_yaw: float = 0.0) -> Path:
    """Return points (n, 2; m) as a path with the present time.

    Each pose is directed to the next point, the last one has ``final_yaw``.
    """
    path = Path()
    path.header.frame_id, path.header.stamp = frame, rospy.Time.now()
    yaws = [*(math.atan2(y, x) for x, y in np.diff(points, axis=0)), final_yaw]
    path.poses = [stamped_pose(Pose2D(x, y, yaw), frame) for (x, y), yaw in zip(points.tolist(), yaws)]
    return path


def grid_message(grid: OccupancyGrid, frame: str, stamp: rospy.Time) -> OccupancyGridMessage:
    """Convert a grid to a message."""
    message = GRID_MESSAGE()
    message.header.frame_id, message.header.stamp = frame, stamp
    message.info.map_load_time = stamp
    message.info.resolution = grid.resolution
    message.info.height, message.info.width = grid.shape
    fill_pose(message.info.origin, Pose2D(grid.origin_x, grid.origin_y))
    message.data = sendable(grid.cells.ravel())
    return message


def grid_from_message(message: OccupancyGridMessage) -> OccupancyGrid:
    """Convert a message to a grid. Raises MapError if the message is inconsistent or its origin is rotated."""
    info, rotation = message.info, message.info.origin.orientation
    if abs(rotation.z) > 1e-6:
        raise MapError("its origin is rotated against its frame (yaw), which is not supported")
    numbers = (info.resolution, info.origin.position.x, info.origin.position.y)
    if not all(map(math.isfinite, numbers)) or info.resolution <= 0.0:
        raise MapError(f"resolution and origin must be finite, and the resolution positive; they are {numbers}")
    if not len(message.data) or info.width * info.height != len(message.data):
        raise MapError(f"it has {len(message.data)} cells, not {info.width} x {info.height}")
    cells = np.array(message.data, dtype=np.int8).reshape(info.height, info.width)
    return OccupancyGrid(cells, *numbers)
