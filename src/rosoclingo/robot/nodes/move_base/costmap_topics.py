"""The topics of one costmap, as costmap_2d publishes them: the whole, what has changed, the robot's footprint."""

import math
from typing import Any, Callable, NamedTuple, Optional, Tuple

import numpy as np
import rospy
from geometry_msgs.msg import Point32, PolygonStamped
from map_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid
from rospy.numpy_msg import numpy_msg

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.nodes.sendable import sendable


class Picture(NamedTuple):
    """A costmap at a time: ``costs`` (int8; height, width), its frame, resolution and lower left corner (m)."""

    costs: np.ndarray
    frame: str
    resolution: float
    origin: Tuple[float, float]

    def same_place(self, other: Optional["Picture"]) -> bool:
        """Tell whether two pictures differ by their costs only."""
        return other is not None and self.costs.shape == other.costs.shape and self[1:] == other[1:]


def whole_map(costmap: Costmap, frame: str) -> Picture:
    """Return all of a costmap, in the map's frame."""
    return Picture(costmap.costs(), frame, costmap.resolution, (costmap.grid.origin_x, costmap.grid.origin_y))


def window(costmap: Costmap, frame: str, in_frame: Pose2D, frame_in_map: Pose2D, size: Tuple[float, float]) -> Picture:
    """Return the part of a costmap around the robot, with the axes of another frame; -1 off the map.

    ``in_frame`` is the robot's pose in that frame, ``frame_in_map`` the frame's pose in the map, ``size`` (width,
    height) in m. The corner moves by whole cells only.
    """
    scale = costmap.resolution
    columns, rows = (max(1, round(length / scale)) for length in size)
    corner = [math.floor(v / scale - n / 2.0) * scale for v, n in zip(in_frame[:2], (columns, rows))]
    first = frame_in_map.compose(Pose2D(corner[0] + 0.5 * scale, corner[1] + 0.5 * scale))
    costs = costmap.costs(first, (rows, columns))
    return Picture(costs, frame, scale, (corner[0], corner[1]))


class CostmapTopics:
    """Publishes a costmap in the node's private namespace; nothing is built that nobody listens to.

    Who subscribes gets the whole costmap at once. Afterwards the whole is published where its place has changed or
    ``send_full`` is set, else only the rectangle that has changed.

    Publishes:
        ~NAME/costmap (nav_msgs/OccupancyGrid), ~NAME/costmap_updates (map_msgs/OccupancyGridUpdate)
        ~NAME/footprint (geometry_msgs/PolygonStamped)
    """

    def __init__(self, name: str, send_full: bool, on_subscriber: Callable[[Callable[[Any], None]], None]) -> None:
        """``on_subscriber`` is called, in any thread, with the function that sends a message to a new subscriber."""
        self._send_full = send_full
        self._last: Optional[Picture] = None
        listener = _Listener(on_subscriber)
        self._whole = prompt_publisher(f"~{name}/costmap", numpy_msg(OccupancyGrid), 2, subscriber_listener=listener)
        self._updates = prompt_publisher(f"~{name}/costmap_updates", numpy_msg(OccupancyGridUpdate), 2)
        self._outline = prompt_publisher(f"~{name}/footprint", PolygonStamped, 2)

    @property
    def wanted(self) -> bool:
        """Whether anybody listens to the costmap."""
        return bool(self._whole.get_num_connections() or self._updates.get_num_connections())

    @property
    def outline_wanted(self) -> bool:
        """Whether anybody listens to the footprint."""
        return bool(self._outline.get_num_connections())

    def show(self, picture: Picture) -> None:
        """Publish a costmap, or what has changed of it."""
        last, self._last = self._last, picture
        if self._send_full or not picture.same_place(last):
            self._whole.publish(whole_message(picture))
            return
        assert last is not None
        changed = np.argwhere(picture.costs != last.costs)
        if len(changed):
            self._updates.publish(_update_message(picture, changed))

    def footprint(self, frame: str, pose: Pose2D, corners: np.ndarray) -> None:
        """Publish where the robot's corners (n, 2; m) are at a pose in a frame."""
        c, s = math.cos(pose.yaw), math.sin(pose.yaw)
        places = corners @ np.array([[c, s], [-s, c]]) + pose[:2]
        message = PolygonStamped()
        message.header.frame_id, message.header.stamp = frame, rospy.Time.now()
        message.polygon.points = [Point32(x, y, 0.0) for x, y in places.tolist()]
        self._outline.publish(message)


class _Listener(rospy.SubscribeListener):  # type: ignore[misc]
    def __init__(self, on_subscriber: Callable[[Callable[[Any], None]], None]) -> None:
        super().__init__()
        self._on_subscriber = on_subscriber

    def peer_subscribe(self, _name: str, _publish: Any, peer_publish: Callable[[Any], None]) -> None:
        """Called by rospy for each new subscriber."""
        self._on_subscriber(peer_publish)


def whole_message(picture: Picture) -> OccupancyGrid:
    """Return a picture as a message, stamped now."""
    message = numpy_msg(OccupancyGrid)()
    message.header.frame_id, message.header.stamp = picture.frame, rospy.Time.now()
    message.info.map_load_time = message.header.stamp
    message.info.resolution = picture.resolution
    message.info.height, message.info.width = picture.costs.shape
    message.info.origin.position.x, message.info.origin.position.y = picture.origin
    message.info.origin.orientation.w = 1.0
    message.data = sendable(picture.costs.ravel())
    return message


def _update_message(picture: Picture, changed: np.ndarray) -> OccupancyGridUpdate:
    """Return the rectangle around changed cells (n, 2) as a message."""
    low, high = changed.min(axis=0), changed.max(axis=0) + 1
    message = numpy_msg(OccupancyGridUpdate)()
    message.header.frame_id, message.header.stamp = picture.frame, rospy.Time.now()
    message.x, message.y = int(low[1]), int(low[0])
    message.width, message.height = int(high[1] - low[1]), int(high[0] - low[0])
    message.data = sendable(picture.costs[low[0] : high[0], low[1] : high[1]].ravel())
    return message
