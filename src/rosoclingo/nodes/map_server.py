"""A map server, as the package map_server has it."""

import math

import numpy as np
import rospy
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMap, GetMapResponse, LoadMap, LoadMapRequest, LoadMapResponse

from rosoclingo.navigation import grid
from rosoclingo.nodes.parameters import parameter


def grid_message(occupancy: grid.OccupancyGrid, frame: str, stamp: rospy.Time) -> OccupancyGrid:
    """Return a grid as a message."""
    message = OccupancyGrid()
    message.header.frame_id, message.header.stamp = frame, stamp
    message.info.map_load_time = stamp
    message.info.resolution = occupancy.resolution
    message.info.height, message.info.width = occupancy.shape
    message.info.origin.position.x, message.info.origin.position.y = occupancy.origin_x, occupancy.origin_y
    message.info.origin.orientation.w = 1.0
    message.data = occupancy.cells.ravel().tolist()
    return message


def grid_from_message(message: OccupancyGrid) -> grid.OccupancyGrid:
    """Return a message as a grid. Raises MapError for one that contradicts itself, and for a turned one."""
    info, rotation = message.info, message.info.origin.orientation
    if abs(rotation.z) > 1e-6:
        raise grid.MapError("its origin is turned against its frame (yaw), which is not supported")
    numbers = (info.resolution, info.origin.position.x, info.origin.position.y)
    if not all(map(math.isfinite, numbers)) or info.resolution <= 0.0:
        raise grid.MapError(f"resolution and origin must be finite, the resolution more than 0; they are {numbers}")
    if not message.data or info.width * info.height != len(message.data):
        raise grid.MapError(f"it has {len(message.data)} cells for {info.width} x {info.height}")
    cells = np.array(message.data, dtype=np.int8).reshape(info.height, info.width)
    return grid.OccupancyGrid(cells, info.resolution, info.origin.position.x, info.origin.position.y)


class MapServerNode:
    """Publishes a map from a file.

    Parameters
    ----------
        ~frame_id (string, "map"): the frame of the map.
        ~map (string): the map's YAML file, unless it is given on the command line.
    Publishes:
        map (nav_msgs/OccupancyGrid, latched), map_metadata (nav_msgs/MapMetaData, latched)
    Services:
        static_map (nav_msgs/GetMap), change_map (nav_msgs/LoadMap)

    """

    def __init__(self, path: str = "") -> None:
        self._frame = parameter("~frame_id", str, "map")
        self._map = rospy.Publisher("map", OccupancyGrid, latch=True, queue_size=1)
        self._metadata = rospy.Publisher("map_metadata", MapMetaData, latch=True, queue_size=1)
        self._show(path or parameter("~map", str))
        self._services = (
            rospy.Service("static_map", GetMap, lambda _: GetMapResponse(map=self._message)),
            rospy.Service("change_map", LoadMap, self._on_change),
        )

    def _show(self, path: str) -> None:
        """Load a map and publish it. Raises MapError."""
        self._message = grid_message(grid.load_map(path), self._frame, rospy.Time.now())
        self._map.publish(self._message)
        self._metadata.publish(self._message.info)
        info = self._message.info
        rospy.loginfo("map %s: %d x %d cells of %.3f m", path, info.width, info.height, info.resolution)

    def _on_change(self, request: LoadMapRequest) -> LoadMapResponse:
        try:
            self._show(request.map_url)
        except grid.MapError as error:
            rospy.logerr("%s", error)
            return LoadMapResponse(map=self._message, result=LoadMapResponse.RESULT_INVALID_MAP_DATA)
        return LoadMapResponse(map=self._message, result=LoadMapResponse.RESULT_SUCCESS)
