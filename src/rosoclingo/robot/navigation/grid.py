"""Occupancy grids, and the map files of map_server (PGM or PNG with YAML)."""

import math
from pathlib import Path
from typing import Any, Dict, Mapping, NamedTuple, Tuple, Union

import numpy as np
from PIL import Image

from rosoclingo.common.reading import Reader, read_yaml

FREE, OCCUPIED, UNKNOWN = 0, 100, -1
MODES = ("trinary", "scale", "raw")
FAR = 1e7  # m: limit of an origin's coordinates


class MapError(ValueError):
    """An invalid map. The message names the file and the key."""


class OccupancyGrid(NamedTuple):
    """A map as in nav_msgs/OccupancyGrid.

    ``cells``: int8 (height, width), row 0 at the bottom (smallest y); 0 free .. 100 occupied, -1 unknown.
    ``resolution``: edge of a cell (m). ``origin_x``, ``origin_y``: lower left corner of cell (0, 0) (m).
    The axes of the grid are those of its frame.
    """

    cells: np.ndarray
    resolution: float
    origin_x: float = 0.0
    origin_y: float = 0.0

    @property
    def shape(self) -> Tuple[int, int]:
        """(height, width) in cells."""
        return self.cells.shape[0], self.cells.shape[1]

    def cell(self, x: float, y: float) -> Tuple[int, int]:
        """Return (row, column) of the cell that contains a point (m), which can lie outside the grid."""
        return (
            math.floor((y - self.origin_y) / self.resolution),
            math.floor((x - self.origin_x) / self.resolution),
        )

    def centre(self, row: int, column: int) -> Tuple[float, float]:
        """Return the centre (x, y) of a cell in m."""
        return (
            self.origin_x + (column + 0.5) * self.resolution,
            self.origin_y + (row + 0.5) * self.resolution,
        )

    def contains(self, x: float, y: float) -> bool:
        """Return whether a point (m) lies on the grid."""
        row, column = self.cell(x, y)
        return 0 <= row < self.shape[0] and 0 <= column < self.shape[1]

    def off_map(self, x: float, y: float) -> str:
        """Return a message if a point (m) is off the grid, else an empty text. Edges belong to the grid."""
        right = self.origin_x + self.shape[1] * self.resolution
        top = self.origin_y + self.shape[0] * self.resolution
        if self.origin_x <= x <= right and self.origin_y <= y <= top:
            return ""
        extent = f"x {self.origin_x:g} .. {right:g}, y {self.origin_y:g} .. {top:g}"
        return f"({x:g}, {y:g}) is off the map, which covers {extent}"

    def occupied(self, threshold: int = OCCUPIED) -> np.ndarray:
        """Return the mask (uint8, shape of the grid) of cells with an occupancy of at least ``threshold``."""
        return np.ascontiguousarray(self.cells >= threshold, dtype=np.uint8)


def read_map_info(path: Union[str, Path]) -> Dict[str, Any]:
    """Read and check the YAML file of a map, and add the defaults of map_server. Raises MapError."""
    reader = read_yaml(path, "map", MapError)
    negate = reader.at("negate")  # map_server accepts numbers
    info = {
        "image": Path(path).parent / reader.at("image").text(wanted="the image's file name"),
        "resolution": reader.at("resolution").number(low=1e-6, high=1e6),
        "origin": _origin(reader.at("origin")),
        "negate": negate.value if isinstance(negate.value, bool) else bool(negate.number(0.0)),
        "occupied_thresh": reader.at("occupied_thresh").number(low=0.0, high=1.0),
        "free_thresh": reader.at("free_thresh").number(low=0.0, high=1.0),
        "mode": reader.at("mode").choice(MODES, "trinary"),
    }
    if not isinstance(reader.value, dict):
        reader.fault("the file must contain keys and values (image, resolution, origin ...)")
    reader.check(MapError)
    return info


def load_map(path: Union[str, Path]) -> OccupancyGrid:
    """Load a map: the YAML file and its image, as map_server does. Raises MapError."""
    info = read_map_info(path)
    try:
        with Image.open(str(info["image"])) as image:
            cells = _cells(image, info)
    except Exception as error:  # noqa: BLE001 Pillow's exceptions depend on the image format
        raise MapError("map {}: image {}: {}".format(path, info["image"], error or repr(error))) from error
    x, y = info["origin"]
    return OccupancyGrid(np.ascontiguousarray(cells[::-1]), info["resolution"], x, y)


def _cells(image: Image.Image, info: Mapping[str, Any]) -> np.ndarray:
    """Return the occupancy of each pixel (int8). A lookup table speeds up images with 256 grey levels."""
    if image.mode in ("1", "L"):
        table = _occupancy((np.arange(256.0), np.full(256, 255.0)), info)
        return np.asarray(table[np.asarray(image.convert("L"))])
    return _occupancy(_levels(image, info["mode"]), info)


def _levels(image: Image.Image, mode: str) -> Tuple[np.ndarray, np.ndarray]:
    """Return (mean colour, opacity) of an image as float arrays of its shape, from 0 to 255.

    In trinary mode the opacity counts as another colour, as in map_server. Raises ValueError for an unsupported image.
    """
    if image.mode == "F":
        raise ValueError("its pixels are floating-point numbers; save it with 8 or 16 bits")
    if image.mode.startswith("I"):  # 16 bits; the upper 8 are used
        grey = np.clip(np.asarray(image, dtype=np.int64), 0, 65535) // 256
        return grey.astype(np.float64), np.full(grey.shape, 255.0)
    transparent = image.mode[-1] in "Aa" or "transparency" in image.info
    rgba = np.asarray(image.convert("RGBA"), dtype=np.float64)
    return rgba[:, :, : 4 if transparent and mode == "trinary" else 3].mean(axis=2), rgba[:, :, 3]


def _occupancy(levels: Tuple[np.ndarray, np.ndarray], info: Mapping[str, Any]) -> np.ndarray:
    """Convert image levels to occupancy, in the modes of map_server."""
    grey, opacity = levels
    if info["mode"] == "raw":
        raw = np.floor(255.0 - grey if info["negate"] else grey)
        return np.where(raw > OCCUPIED, UNKNOWN, raw).astype(np.int8)
    darkness = (grey if info["negate"] else 255.0 - grey) / 255.0
    occupied, free = darkness > info["occupied_thresh"], darkness < info["free_thresh"]
    if info["mode"] == "scale":
        span = info["occupied_thresh"] - info["free_thresh"]
        between = 1 + 98 * (darkness - info["free_thresh"]) / (span if span > 0 else 1.0)
        between = np.where(opacity == 0.0, UNKNOWN, np.clip(between, 1, 99))
    else:
        between = np.full(grey.shape, UNKNOWN)
    return np.where(occupied, OCCUPIED, np.where(free, FREE, between)).astype(np.int8)


def _origin(reader: Reader) -> Tuple[float, float]:
    origin = reader.numbers((2, 3), wanted="[x, y, yaw] in m, m, rad")
    if max(map(abs, origin[:2])) > FAR:
        reader.fault(f"x and y must be within {FAR:g} m, not {list(origin[:2])}")
    if origin[2:] not in ((), (0.0,)):
        reader.fault("rotated maps (yaw) are not supported; rotate the image and set the yaw to 0")
    return origin[0], origin[1]
