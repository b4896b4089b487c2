"""rviz's configuration for a map and robots: the view of the map, the size of texts, and displays. Lengths in m."""

from typing import Any, Dict, List, NamedTuple, Sequence, Tuple

import numpy as np

from rosoclingo.nodes.rviz.panel import HEIGHT, WIDTH
from rosoclingo.runs.map_image import known_part
from rosoclingo.runs.planar_frames import Pose

USUAL = WIDTH  # width of a map for which texts and arrows have their default size
PROPORTION = 1.4  # a window's width divided by its height
MARGIN = 0.03  # of the picture, on each side
FRAME = (32, 92)  # pixels of width and height for rviz's menu, tools and status
OF_ROBOTS = ("rviz/LaserScan", "rviz/Path")  # classes of displays of which each robot has its own

Bounds = Tuple[float, float, float, float]  # minimum x, minimum y, maximum x, maximum y


class MapView(NamedTuple):
    """rviz's view from above: its centre (m) and its scale (pixels per metre)."""

    x: float
    y: float
    scale: float


def known_bounds(cells: np.ndarray, resolution: float, origin: Pose) -> Bounds:
    """Return the bounds of a map's known cells (int8, -1 unknown), else of the map, from its ``origin`` on."""
    row, column, known = known_part(cells)
    height, width = known.shape
    along = np.array([column, column + width, column, column + width]) * resolution
    across = np.array([row, row, row + height, row + height]) * resolution
    x, y = origin.outward(along, across)
    return float(x.min()), float(y.min()), float(x.max()), float(y.max())


def bounds_of(message: Any) -> Bounds:
    """Return the bounds of a nav_msgs/OccupancyGrid's known cells."""
    info = message.info
    cells = np.array(message.data, dtype=np.int8).reshape(info.height, info.width)
    return known_bounds(cells, info.resolution, Pose.of(info.origin.position, info.origin.orientation))


def text_factor(bounds: Bounds) -> float:
    """Return the factor by which texts and arrows have to grow to be readable in a view of the whole map."""
    return max(0.25, max(bounds[2] - bounds[0], PROPORTION * (bounds[3] - bounds[1])) / USUAL)


def view_of(bounds: Bounds, size: Tuple[int, int]) -> MapView:
    """Return the view of a map and the texts below it, in a window of width and height in pixels."""
    x0, y0, x1, y1 = bounds
    y0 -= HEIGHT * text_factor(bounds)
    room = 1.0 - 2.0 * MARGIN
    width, height = (max(1, whole - frame) for whole, frame in zip(size, FRAME))
    wide = max(x1 - x0, WIDTH * text_factor(bounds))
    return MapView((x0 + x1) / 2.0, (y0 + y1) / 2.0, room * min(width / wide, height / (y1 - y0)))


def with_view(config: Dict[str, Any], view: MapView, size: Tuple[int, int]) -> Dict[str, Any]:
    """Return an rviz configuration with another view from above and another window size."""
    manager = config["Visualization Manager"]
    views = {**manager["Views"], "Current": {**manager["Views"]["Current"], "X": view.x, "Y": view.y}}
    views["Current"]["Scale"] = view.scale
    window = {**config["Window Geometry"], "Width": size[0], "Height": size[1]}
    return {**config, "Visualization Manager": {**manager, "Views": views}, "Window Geometry": window}


def with_robots(config: Dict[str, Any], robots: Sequence[str]) -> Dict[str, Any]:
    """Return an rviz configuration in which each of several robots has displays of its scan and path.

    Their topics are relative, in the robot's namespace. Without ``robots``, the configuration is unchanged.
    """
    manager = config["Visualization Manager"]
    displays: List[Dict[str, Any]] = []
    for one in manager["Displays"]:
        names = robots if one.get("Class") in OF_ROBOTS else ()
        own = [{**one, "Name": f"{one['Name']} of {name}", "Topic": f"{name}/{one['Topic']}"} for name in names]
        displays += own or [one]
    return {**config, "Visualization Manager": {**manager, "Displays": displays}}
