"""Which part of a map to show, and how large: rviz's view and the texts in it. Lengths in m."""

import math
from typing import Any, Dict, NamedTuple, Tuple

import numpy as np

from rosoclingo.nodes.rviz.panel import HEIGHT, WIDTH

__all__ = ["MapView", "bounds_of", "known", "text_factor", "view_of", "with_view"]

USUAL = WIDTH  # m across that the usual sizes of texts and arrows are made for
PROPORTION = 1.4  # of a window's width to its height
NEAR = 1.0  # m between the bounds of what is known and those of the map, in usual sizes
MARGIN = 0.03  # of the picture, on each side
FRAME = (32, 92)  # pixels of width and height that rviz takes for menu, tools and status

Bounds = Tuple[float, float, float, float]  # least x, least y, greatest x, greatest y


class MapView(NamedTuple):
    """rviz's view from above: the middle (m), and how many pixels a metre takes."""

    x: float
    y: float
    scale: float


def known(cells: np.ndarray, resolution: float, origin: Tuple[float, float, float]) -> Bounds:
    """Bounds of what a map (int8, -1 unknown) knows, else of all of it; ``origin``: x and y (m), yaw (rad)."""
    rows, columns = np.nonzero(cells >= 0)
    if not len(rows):
        rows, columns = np.array([0, cells.shape[0] - 1]), np.array([0, cells.shape[1] - 1])
    along = np.array([columns.min(), columns.max() + 1, columns.min(), columns.max() + 1]) * resolution
    across = np.array([rows.min(), rows.min(), rows.max() + 1, rows.max() + 1]) * resolution
    c, s = math.cos(origin[2]), math.sin(origin[2])
    x, y = origin[0] + c * along - s * across, origin[1] + s * along + c * across
    return float(x.min()), float(y.min()), float(x.max()), float(y.max())


def bounds_of(message: Any) -> Bounds:
    """Bounds of what a nav_msgs/OccupancyGrid knows, or its own where they are so near that words would lie on both."""
    info = message.info
    cells = np.array(message.data, dtype=np.int8).reshape(info.height, info.width)
    turn, corner = info.origin.orientation, info.origin.position
    yaw = math.atan2(2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y**2 + turn.z**2))
    origin = (corner.x, corner.y, yaw)
    inner, outer = known(cells, info.resolution, origin), known(np.zeros_like(cells), info.resolution, origin)
    near = NEAR * text_factor(inner)
    x0, y0, x1, y1 = (edge if abs(edge - own) <= near else own for own, edge in zip(inner, outer))
    return x0, y0, x1, y1


def text_factor(bounds: Bounds) -> float:
    """By how much texts and arrows have to be larger than usual to be read when the whole map is seen."""
    return max(0.25, max(bounds[2] - bounds[0], PROPORTION * (bounds[3] - bounds[1])) / USUAL)


def view_of(bounds: Bounds, size: Tuple[int, int]) -> MapView:
    """The view of a map and the words below it in a window of width and height in pixels."""
    x0, y0, x1, y1 = bounds
    y0 -= HEIGHT * text_factor(bounds)
    room = 1.0 - 2.0 * MARGIN
    width, height = (max(1, whole - frame) for whole, frame in zip(size, FRAME))
    wide = max(x1 - x0, WIDTH * text_factor(bounds))
    return MapView((x0 + x1) / 2.0, (y0 + y1) / 2.0, room * min(width / wide, height / (y1 - y0)))


def with_view(config: Dict[str, Any], view: MapView, size: Tuple[int, int]) -> Dict[str, Any]:
    """An rviz configuration with another view from above and another size of the window."""
    manager = config["Visualization Manager"]
    views = {**manager["Views"], "Current": {**manager["Views"]["Current"], "X": view.x, "Y": view.y}}
    views["Current"]["Scale"] = view.scale
    window = {**config["Window Geometry"], "Width": size[0], "Height": size[1]}
    return {**config, "Visualization Manager": {**manager, "Views": views}, "Window Geometry": window}
