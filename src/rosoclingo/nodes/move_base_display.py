"""What the move_base node shows: plans, costmaps, footprints."""

import math
from typing import Optional, Tuple

import numpy as np
import rospy
from geometry_msgs.msg import Point32, PolygonStamped, PoseStamped
from nav_msgs.msg import OccupancyGrid, Path

from rosoclingo.navigation import Costmap, Pose2D
from rosoclingo.nodes.localization import fill_pose
from rosoclingo.nodes.move_base_parameters import DEFAULT_GLOBAL, DEFAULT_LOCAL, Settings, plugin_namespace


def path_message(points: np.ndarray, frame: str, stamp: rospy.Time, final_yaw: float = 0.0) -> Path:
    """Return points (n, 2; m) as a path; each pose looks to the next, the last one to ``final_yaw``."""
    message = Path()
    message.header.frame_id, message.header.stamp = frame, stamp
    yaws = [*np.arctan2(*np.diff(points, axis=0).T[::-1]).tolist(), final_yaw]
    for (x, y), yaw in zip(points.tolist(), yaws):
        pose = PoseStamped()
        pose.header = message.header
        fill_pose(pose.pose, Pose2D(x, y, yaw))
        message.poses.append(pose)
    return message


class Display:
    """The publishers of plans, costmaps and footprints; nothing is built that nobody listens to."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._frame = settings.frames.map
        planner = "~" + plugin_namespace("~base_global_planner", DEFAULT_GLOBAL)
        follower = "~" + plugin_namespace("~base_local_planner", DEFAULT_LOCAL)
        self._plan = rospy.Publisher(planner + "/plan", Path, queue_size=1)
        self._global_plan = rospy.Publisher(follower + "/global_plan", Path, queue_size=1)
        self._local_plan = rospy.Publisher(follower + "/local_plan", Path, queue_size=1)
        self._costmaps = tuple(
            rospy.Publisher(f"~{name}_costmap/costmap", OccupancyGrid, queue_size=1, latch=True)
            for name in ("global", "local")
        )
        self._footprints = tuple(
            rospy.Publisher(f"~{name}_costmap/footprint", PolygonStamped, queue_size=1) for name in ("global", "local")
        )
        self._shown = [-math.inf, -math.inf]

    def plan(self, points: np.ndarray, final_yaw: float) -> None:
        """Show a new path."""
        if self._plan.get_num_connections() or self._global_plan.get_num_connections():
            message = path_message(points, self._frame, rospy.Time.now(), final_yaw)
            self._plan.publish(message)
            self._global_plan.publish(message)

    def trajectory(self, points: np.ndarray) -> None:
        """Show where the present command leads."""
        if self._local_plan.get_num_connections():
            self._local_plan.publish(path_message(points, self._frame, rospy.Time.now()))

    def costmaps(self, costmap: Costmap, pose: Pose2D, now: float, fresh: bool = False) -> None:
        """Show the costmaps that are due; ``fresh``: the map is new, show all of it."""
        if now < max(self._shown):
            self._shown = [-math.inf, -math.inf]
        for i, publisher in enumerate(self._costmaps):
            due = now - self._shown[i] >= self._settings.publish_periods[i] - 1e-6
            if fresh or (due and publisher.get_num_connections()):
                self._shown[i] = now
                publisher.publish(self._grid(costmap, self._window(costmap, pose) if i else None))
                self._footprint(i, pose)

    def _footprint(self, index: int, pose: Pose2D) -> None:
        publisher = self._footprints[index]
        if not publisher.get_num_connections():
            return
        radius = self._settings.costmap.robot_radius
        ring = [(radius * math.cos(a), radius * math.sin(a)) for a in np.linspace(0.0, 2.0 * math.pi, 17)[:-1]]
        message = PolygonStamped()
        message.header.frame_id, message.header.stamp = self._frame, rospy.Time.now()
        corners = [pose.compose(Pose2D(x, y)) for x, y in (self._settings.footprint or ring)]
        message.polygon.points = [Point32(c.x, c.y, 0.0) for c in corners]
        publisher.publish(message)

    def _window(self, costmap: Costmap, pose: Pose2D) -> Tuple[int, int, int, int]:
        """Return the part of the map around the robot that the local costmap shows."""
        width, height = (size / 2.0 for size in self._settings.local_size)
        low = costmap.grid.cell(pose.x - width, pose.y - height)
        high = costmap.grid.cell(pose.x + width, pose.y + height)
        rows, columns = costmap.grid.shape
        return (
            min(rows, max(0, low[0])), min(rows, max(0, high[0])),
            min(columns, max(0, low[1])), min(columns, max(0, high[1])),
        )  # fmt: skip

    def _grid(self, costmap: Costmap, window: Optional[Tuple[int, int, int, int]]) -> OccupancyGrid:
        row0, row1, column0, column1 = window or (0, costmap.grid.shape[0], 0, costmap.grid.shape[1])
        message = OccupancyGrid()
        message.header.frame_id, message.header.stamp = self._frame, rospy.Time.now()
        message.info.resolution = costmap.resolution
        message.info.height, message.info.width = row1 - row0, column1 - column0
        message.info.origin.position.x = costmap.grid.origin_x + column0 * costmap.resolution
        message.info.origin.position.y = costmap.grid.origin_y + row0 * costmap.resolution
        message.info.origin.orientation.w = 1.0
        message.data = costmap.costs((row0, row1, column0, column1)).ravel().tolist()
        return message
