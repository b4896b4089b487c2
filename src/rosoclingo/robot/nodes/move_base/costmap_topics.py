"""Topics of a costmap as in costmap_2d: the full costmap, its updates, and the robot's footprint."""

import math
from typing import Any, Callable, NamedTuple, Optional, Tuple

import numpy as np
import rospy
from geometry_msgs.msg import Point32, PolygonStamped
from map_msgs.msg import OccupancyGridUpdate
from rospy.numpy_msg import numpy_msg

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import OccupancyGrid
from rosoclingo.robot.nodes.messages import GRID_MESSAGE, grid_message, sendable


class CostmapView(NamedTuple):
    """A costmap, the frame in which it is published, and the poses of that frame and of the robot in the map.

    The robot's pose is None if unknown.
    """

    costmap: Costmap
    frame: str
    frame_in_map: Pose2D
    pose: Optional[Pose2D]

    @property
    def in_frame(self) -> Pose2D:
        """Pose of the robot in the frame of the view."""
        assert self.pose is not None
        return self.frame_in_map.inverse().compose(self.pose)


def costs(view: CostmapView, size: Optional[Tuple[float, float]]) -> OccupancyGrid:
    """Return the costs of a costmap, or of a window (width, height in m) around the robot; -1 off the map.

    A window is aligned with the axes of the frame, and moves by whole cells.
    """
    costmap, scale = view.costmap, view.costmap.resolution
    if size is None:
        return costmap.grid._replace(cells=costmap.costs())
    columns, rows = (max(1, round(length / scale)) for length in size)
    x, y = (math.floor(v / scale - n / 2.0) * scale for v, n in zip(view.in_frame[:2], (columns, rows)))
    first = view.frame_in_map.compose(Pose2D(x + 0.5 * scale, y + 0.5 * scale))
    return OccupancyGrid(costmap.costs_around(first, (rows, columns)), scale, x, y)


class CostmapTopics(rospy.SubscribeListener):  # type: ignore[misc]
    """Publishes a costmap in the node's private namespace. Messages are only built for subscribers.

    A new subscriber receives the full costmap at once. After that, the topics carry the changed rectangle, or the full
    costmap if its position has changed or ``send_full`` is set.

    ``periods``: publishing periods (s) of the costmap and of the footprint. ``size``: size (m) of the window, None for
    the whole map. ``view`` is what the topics show, None before the first one.

    Publishes:
        ~NAME/costmap (nav_msgs/OccupancyGrid), ~NAME/costmap_updates (map_msgs/OccupancyGridUpdate)
        ~NAME/footprint (geometry_msgs/PolygonStamped)
    """

    def __init__(
        self, name: str, send_full: bool, periods: Tuple[float, float], size: Optional[Tuple[float, float]],
        corners: np.ndarray, worker: Worker,
    ) -> None:  # fmt: skip
        super().__init__()
        self._send_full, self._periods, self._size = send_full, periods, size
        self._corners, self._worker = corners, worker
        self.view: Optional[CostmapView] = None
        self._last: Optional[OccupancyGrid] = None
        self._last_frame = ""
        self._shown = [-math.inf, -math.inf]  # times (s) of the last costmap and footprint
        self._whole = prompt_publisher(f"~{name}/costmap", GRID_MESSAGE, 2, subscriber_listener=self)
        self._updates = prompt_publisher(f"~{name}/costmap_updates", numpy_msg(OccupancyGridUpdate), 2)
        self._outline = prompt_publisher(f"~{name}/footprint", PolygonStamped, 2)

    def publish_due(self, now: float) -> None:
        """Publish the costmap and the footprint if they are due at a time (s)."""
        if self.view is None or self.view.pose is None:
            return
        if now < max(self._shown):
            self._shown = [-math.inf, -math.inf]
        listeners = self._whole.get_num_connections() + self._updates.get_num_connections()
        for which, wanted, publish in (
            (0, listeners, self.publish_costs),
            (1, self._outline.get_num_connections(), self._publish_footprint),
        ):
            if wanted and now - self._shown[which] >= self._periods[which] - 1e-6:
                self._shown[which] = now
                publish()

    def publish_costs(self) -> None:
        """Publish the changed rectangle, or the full costmap where necessary."""
        assert self.view is not None
        grid, last, frame = costs(self.view, self._size), self._last, self.view.frame
        same_place = last is not None and (grid.shape, *grid[1:], frame) == (last.shape, *last[1:], self._last_frame)
        self._last, self._last_frame = grid, frame
        if last is None or self._send_full or not same_place:
            self._whole.publish(grid_message(grid, frame, rospy.Time.now()))
            return
        changed = np.argwhere(grid.cells != last.cells)
        if len(changed):
            low, high = changed.min(axis=0), changed.max(axis=0) + 1
            message = numpy_msg(OccupancyGridUpdate)()
            message.header.frame_id, message.header.stamp = frame, rospy.Time.now()
            message.x, message.y = int(low[1]), int(low[0])
            message.width, message.height = int(high[1] - low[1]), int(high[0] - low[0])
            message.data = sendable(grid.cells[low[0] : high[0], low[1] : high[1]].ravel())
            self._updates.publish(message)

    def _publish_footprint(self) -> None:
        assert self.view is not None
        pose, message = self.view.in_frame, PolygonStamped()
        message.header.frame_id, message.header.stamp = self.view.frame, rospy.Time.now()
        message.polygon.points = [Point32(*pose.compose(Pose2D(x, y))[:2], 0.0) for x, y in self._corners.tolist()]
        self._outline.publish(message)

    def peer_subscribe(self, _name: str, _publish: Any, peer_publish: Callable[[Any], None]) -> None:
        """Send the full costmap to a new subscriber. Called by rospy, in any thread."""
        self._worker.put(self._greet, peer_publish)

    def _greet(self, send: Callable[[Any], None]) -> None:
        if self.view is not None:
            send(grid_message(costs(self.view, self._size), self.view.frame, rospy.Time.now()))
