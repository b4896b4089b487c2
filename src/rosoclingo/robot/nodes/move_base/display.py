"""Visualisation topics of the move_base node: goals, plans, costmaps, footprints and recoveries."""

import math
from typing import Any, Callable

import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import RecoveryStatus
from nav_msgs.msg import Path

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.nodes.messages import path_message, stamped_pose
from rosoclingo.robot.nodes.move_base.costmap_topics import CostmapTopics, CostmapView
from rosoclingo.robot.nodes.move_base.navigation_settings import Settings
from rosoclingo.robot.nodes.move_base.plugins import global_planner_namespace, local_planner_namespace

HERE = Pose2D(0.0, 0.0)


class Display:
    """Publishes goals, plans, costmaps and footprints. Large messages are only built for subscribers.

    Paths of the local planner and the local costmap are in the local frame (odometry), the others in the map frame.

    Publishes:
        ~current_goal (geometry_msgs/PoseStamped), ~recovery_status (move_base_msgs/RecoveryStatus)
        ~PLANNER/plan, ~FOLLOWER/global_plan, ~FOLLOWER/local_plan (nav_msgs/Path)
    """

    def __init__(self, settings: Settings, worker: Worker) -> None:
        self._frame = settings.map_frame
        planner, follower = "~" + global_planner_namespace(), "~" + local_planner_namespace()
        self._goal = rospy.Publisher("~current_goal", PoseStamped, queue_size=1)
        self._recovery = rospy.Publisher("~recovery_status", RecoveryStatus, queue_size=5)
        self._plan = prompt_publisher(planner + "/plan", Path, 2)
        self._global_plan = prompt_publisher(follower + "/global_plan", Path, 2)
        self._local_plan = prompt_publisher(follower + "/local_plan", Path, 2)
        angles = np.linspace(0.0, 2.0 * math.pi, 17)[:-1]
        ring = settings.costmap.robot_radius * np.stack((np.cos(angles), np.sin(angles)), axis=1)
        corners = np.array(settings.footprint) if settings.footprint else ring
        self._global, self._local = (
            CostmapTopics(name, settings.send_full[i], (settings.publish_periods[i], settings.update_periods[i]), size,
                          corners, worker)
            for i, (name, size) in enumerate((("global_costmap", None), ("local_costmap", settings.local_size)))
        )  # fmt: skip

    def goal(self, pose: Pose2D) -> None:
        """Publish the present goal (m, in the map frame)."""
        self._goal.publish(stamped_pose(pose, self._frame))

    def recovery(self, behavior: Any, number: int, total: int, pose: Pose2D) -> None:
        """Publish the start of a recovery behaviour: its index, the number of behaviours, and the robot's pose."""
        self._recovery.publish(RecoveryStatus(stamped_pose(pose, self._frame), number, total, behavior.name))

    def plan(self, points: np.ndarray, final_yaw: float) -> None:
        """Publish a new path (m, in the map frame)."""
        if self._plan.get_num_connections():
            self._plan.publish(path_message(points, self._frame, final_yaw))
        if self._global_plan.get_num_connections():
            self._global_plan.publish(self._in_local_frame(points, final_yaw))

    def trajectory(self, points: Callable[[], np.ndarray]) -> None:
        """Publish the trajectory of the present command (m, in the map frame)."""
        if self._local_plan.get_num_connections():
            self._local_plan.publish(self._in_local_frame(points(), 0.0))

    def new_map(self, costmap: Costmap) -> None:
        """Publish the costmap of a new map, even if the pose of the robot is unknown."""
        self._local.view = None
        self._global.view = CostmapView(costmap, self._frame, HERE, None)
        self._global.publish_costs()

    def update(self, costmap: Costmap, pose: Pose2D, local_frame: str, local_in_map: Pose2D) -> None:
        """Set the costmap to publish, and the poses of the robot and of the local frame in the map."""
        self._local.view = CostmapView(costmap, local_frame, local_in_map, pose)
        self._global.view = CostmapView(costmap, self._frame, HERE, pose)

    def costmaps(self, now: float) -> None:
        """Publish the costmaps and footprints that are due at a time (s)."""
        self._global.publish_due(now)
        self._local.publish_due(now)

    def _in_local_frame(self, points: np.ndarray, final_yaw: float) -> Path:
        view = self._local.view
        if view is None:
            return path_message(points, self._frame, final_yaw)
        back = view.frame_in_map.inverse()
        points = np.array([back.compose(Pose2D(x, y))[:2] for x, y in points.tolist()]).reshape(-1, 2)
        return path_message(points, view.frame, final_yaw + back.yaw)
