"""What the move_base node publishes of a goal on its way, besides the action's own topics."""

import math
from typing import Any

import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import RecoveryStatus
from nav_msgs.msg import Path

from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.nodes.localization import fill_pose


def stamped_pose(pose: Pose2D, frame: str) -> PoseStamped:
    """Return a pose (m, rad) in a frame as a message, stamped now."""
    message = PoseStamped()
    message.header.frame_id, message.header.stamp = frame, rospy.Time.now()
    fill_pose(message.pose, pose)
    return message


def path_message(points: np.ndarray, frame: str, final_yaw: float = 0.0) -> Path:
    """Return points (n, 2; m) as a path, stamped now; each pose looks to the next, the last one to ``final_yaw``."""
    path = Path()
    path.header.frame_id, path.header.stamp = frame, rospy.Time.now()
    yaws = [*(math.atan2(y, x) for x, y in np.diff(points, axis=0)), final_yaw]
    path.poses = [stamped_pose(Pose2D(x, y, yaw), frame) for (x, y), yaw in zip(points.tolist(), yaws)]
    return path


class Reports:
    """Publishes poses of the map's frame.

    Publishes:
        ~current_goal (geometry_msgs/PoseStamped), ~recovery_status (move_base_msgs/RecoveryStatus)
    """

    def __init__(self, map_frame: str) -> None:
        self._frame = map_frame
        self._current_goal = rospy.Publisher("~current_goal", PoseStamped, queue_size=1)
        self._recovery = rospy.Publisher("~recovery_status", RecoveryStatus, queue_size=5)

    def goal(self, pose: Pose2D) -> None:
        """Publish the goal that is driven to."""
        self._current_goal.publish(stamped_pose(pose, self._frame))

    def recovery(self, behavior: Any, number: int, total: int, pose: Pose2D) -> None:
        """Publish that a recovery behaviour begins, the ``number``-th of ``total`` from 0 on, the robot at a pose."""
        message = RecoveryStatus()
        message.pose_stamped = stamped_pose(pose, self._frame)
        message.current_recovery_number, message.total_number_of_recoveries = number, total
        message.recovery_behavior_name = behavior.name
        self._recovery.publish(message)
