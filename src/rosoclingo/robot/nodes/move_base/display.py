"""What the move_base node shows: plans, costmaps, footprints."""

import math
from typing import Any, Callable, NamedTuple, Optional, Tuple

import numpy as np
from nav_msgs.msg import Path

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.nodes.move_base.costmap_topics import CostmapTopics, Picture, whole_map, whole_message, window
from rosoclingo.robot.nodes.move_base.navigation_settings import Settings
from rosoclingo.robot.nodes.move_base.plugins import global_planner_namespace, local_planner_namespace
from rosoclingo.robot.nodes.move_base.reports import path_message

GLOBAL, LOCAL = 0, 1


class CostmapView(NamedTuple):
    """What there is to show: the costmap, the robot's pose (m) in the map, and the local frame with its pose there."""

    costmap: Costmap
    pose: Pose2D
    local_frame: str
    local_in_map: Pose2D


class Display:
    """The publishers of plans, costmaps and footprints; nothing is built that nobody listens to.

    The local planner's paths and the local costmap are shown in the local frame, odometry's, all else in the map's.
    """

    def __init__(self, settings: Settings, worker: Worker) -> None:
        self._settings, self._worker = settings, worker
        self._frame = settings.frames.map
        planner, follower = "~" + global_planner_namespace(), "~" + local_planner_namespace()
        self._plan = prompt_publisher(planner + "/plan", Path, 2)
        self._global_plan = prompt_publisher(follower + "/global_plan", Path, 2)
        self._local_plan = prompt_publisher(follower + "/local_plan", Path, 2)
        self._costmaps = (
            CostmapTopics("global_costmap", settings.send_full[GLOBAL], lambda send: self._greet(GLOBAL, send)),
            CostmapTopics("local_costmap", settings.send_full[LOCAL], lambda send: self._greet(LOCAL, send)),
        )
        self._shown, self._outlined = [-math.inf, -math.inf], [-math.inf, -math.inf]
        angles = np.linspace(0.0, 2.0 * math.pi, 17)[:-1]
        ring = settings.costmap.robot_radius * np.stack((np.cos(angles), np.sin(angles)), axis=1)
        self._corners = np.array(settings.footprint) if settings.footprint else ring
        self._costmap: Optional[Costmap] = None
        self._view: Optional[CostmapView] = None

    def plan(self, points: np.ndarray, final_yaw: float) -> None:
        """Show a new path (m; in the map)."""
        if self._plan.get_num_connections():
            self._plan.publish(path_message(points, self._frame, final_yaw))
        if self._global_plan.get_num_connections():
            self._global_plan.publish(self._in_local_frame(points, final_yaw))

    def trajectory(self, points: Callable[[], np.ndarray]) -> None:
        """Show where the present command leads (m; in the map)."""
        if self._local_plan.get_num_connections():
            self._local_plan.publish(self._in_local_frame(points(), 0.0))

    def new_map(self, costmap: Costmap) -> None:
        """Show a costmap as soon as there is a map, even if nobody knows where the robot is."""
        self._costmap, self._view = costmap, None
        self._costmaps[GLOBAL].show(whole_map(costmap, self._frame))

    def see(self, view: CostmapView) -> None:
        """Take what there is to show from now on."""
        self._view = view

    def costmaps(self, now: float) -> None:
        """Show the costmaps and footprints that are due at a time (s)."""
        view = self._view
        if view is None:
            return
        if now < max(self._shown + self._outlined):
            self._shown, self._outlined = [-math.inf, -math.inf], [-math.inf, -math.inf]
        for which, topics in enumerate(self._costmaps):
            if topics.wanted and now - self._shown[which] >= self._settings.publish_periods[which] - 1e-6:
                self._shown[which] = now
                topics.show(self._picture(which, view))
            if topics.outline_wanted and now - self._outlined[which] >= self._settings.update_periods[which] - 1e-6:
                self._outlined[which] = now
                topics.footprint(*self._outline(which, view))

    def _greet(self, which: int, send: Callable[[Any], None]) -> None:
        """Have a new subscriber sent the whole costmap."""
        self._worker.put(lambda: self._send(which, send))

    def _send(self, which: int, send: Callable[[Any], None]) -> None:
        if self._view is not None:
            send(whole_message(self._picture(which, self._view)))
        elif which == GLOBAL and self._costmap is not None:
            send(whole_message(whole_map(self._costmap, self._frame)))

    def _picture(self, which: int, view: CostmapView) -> Picture:
        if which == GLOBAL:
            return whole_map(view.costmap, self._frame)
        in_frame = view.local_in_map.inverse().compose(view.pose)
        return window(view.costmap, view.local_frame, in_frame, view.local_in_map, self._settings.local_size)

    def _outline(self, which: int, view: CostmapView) -> Tuple[str, Pose2D, Any]:
        if which == GLOBAL:
            return self._frame, view.pose, self._corners
        return view.local_frame, view.local_in_map.inverse().compose(view.pose), self._corners

    def _in_local_frame(self, points: np.ndarray, final_yaw: float) -> Path:
        if self._view is None:
            return path_message(points, self._frame, final_yaw)
        back = self._view.local_in_map.inverse()
        if any(back):
            c, s = math.cos(back.yaw), math.sin(back.yaw)
            points = points @ np.array([[c, s], [-s, c]]) + (back.x, back.y)
        return path_message(points, self._view.local_frame, final_yaw + back.yaw)
