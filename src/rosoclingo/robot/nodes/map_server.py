"""Map server node, with the interface of map_server."""

import os
from pathlib import Path

import rospkg
import rospy
from nav_msgs.msg import MapMetaData
from nav_msgs.srv import GetMap, GetMapResponse, LoadMap, LoadMapRequest, LoadMapResponse
from rospy.numpy_msg import numpy_msg

from rosoclingo.common.parameters import Parameters
from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation import grid
from rosoclingo.robot.nodes.messages import GRID_MESSAGE, grid_message

# Responses that serialise maps from arrays: element by element, a large map takes seconds.
MAP_ANSWER, CHANGE_ANSWER = numpy_msg(GetMapResponse), numpy_msg(LoadMapResponse)


class MapServerNode:
    """Publishes a map from a file.

    Parameters
    ----------
        ~frame_id (str, default "map"): the frame of the map.
        ~map (str, required): the YAML file of the map, unless the command line names it.
    Publishes:
        map (nav_msgs/OccupancyGrid, latched), map_metadata (nav_msgs/MapMetaData, latched)
    Services:
        static_map (nav_msgs/GetMap), change_map (nav_msgs/LoadMap)

    """

    def __init__(self, path: str = "") -> None:
        given = Parameters()
        self._frame = given.at("frame_id").text("map")
        path = path or given.at("map").text()
        given.check()
        self._map = rospy.Publisher("map", GRID_MESSAGE, latch=True, queue_size=1)
        self._metadata = rospy.Publisher("map_metadata", MapMetaData, latch=True, queue_size=1)
        self._show(path)
        self._worker = Worker()
        self._worker.start()
        self._services = (
            rospy.Service("static_map", GetMap, lambda _: self._worker.ask(lambda: MAP_ANSWER(map=self._message))),
            rospy.Service("change_map", LoadMap, lambda request: self._worker.ask(lambda: self._change(request))),
        )
        rospy.on_shutdown(lambda: self._worker.stop(2.0))

    def _show(self, path: str) -> None:
        """Load and publish a map. Raises MapError."""
        self._message = grid_message(grid.load_map(path), self._frame, rospy.Time.now())
        self._map.publish(self._message)
        self._metadata.publish(self._message.info)
        info = self._message.info
        rospy.loginfo("map %s: %d x %d cells of %.3f m", path, info.width, info.height, info.resolution)

    def _change(self, request: LoadMapRequest) -> LoadMapResponse:
        try:
            path = local_path(request.map_url)
            if not os.path.isfile(str(path)):  # Path.is_file raises for invalid paths
                return self._refused(f"there is no file {path}", LoadMapResponse.RESULT_MAP_DOES_NOT_EXIST)
            grid.read_map_info(path)
        except grid.MapError as error:
            return self._refused(str(error), LoadMapResponse.RESULT_INVALID_MAP_METADATA)
        try:
            self._show(str(path))
        except grid.MapError as error:
            return self._refused(str(error), LoadMapResponse.RESULT_INVALID_MAP_DATA)
        return CHANGE_ANSWER(map=self._message, result=LoadMapResponse.RESULT_SUCCESS)

    def _refused(self, reason: str, result: int) -> LoadMapResponse:
        """Return the response for a map that was not loaded. The old map stays."""
        rospy.logerr("change_map: %s", reason)
        return CHANGE_ANSWER(map=self._message, result=result)


def local_path(url: str) -> Path:
    """Return the file of a URL: a path, file:///PATH or package://PACKAGE/PATH. Raises MapError."""
    kind, found, rest = url.partition("://")
    if not found or kind == "file":
        return Path(rest if found else url)
    package, _, inside = rest.partition("/")
    if kind != "package" or not package:
        raise grid.MapError(f"map {url}: must be a path, file:///PATH or package://PACKAGE/PATH")
    try:
        return Path(rospkg.RosPack().get_path(package)) / inside
    except rospkg.ResourceNotFound as error:
        raise grid.MapError(f"map {url}: there is no package {package!r}") from error
