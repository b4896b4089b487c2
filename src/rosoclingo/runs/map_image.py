"""A map as a small image for pages, cropped to its known part and transparent where the floor is free."""

import base64
import math
import struct
import zlib
from typing import Any, Dict, Sequence, Tuple

import numpy as np

from rosoclingo.runs.planar_frames import Pose

#: The values of a map (nav_msgs/OccupancyGrid) up to which a cell is free, and from which it is occupied.
FREE, OCCUPIED = 25, 65

#: Limit of pixels of an image's longer side.
LONGEST = 2048

#: Red, green, blue and opacity of free, unknown and occupied cells.
PALETTE = ((255, 255, 255, 0), (128, 128, 128, 72), (52, 60, 74, 255))


def map_image(cells: Sequence[int], width: int, resolution: float, origin: Pose) -> Dict[str, Any]:
    """Return a map (int8, rows of ``width`` cells from the origin on, -1 unknown) as an image for a page.

    ``origin`` is the pose of the first cell's corner. The result has the image as a ``data:`` URL, its
    ``corner`` (x, y of its lower left, m), ``yaw`` (rad), ``width`` and ``height`` (m).
    """
    row, column, known = known_part(np.array(cells, dtype=np.int8).reshape(-1, width))
    kinds = np.where(known >= OCCUPIED, 2, np.where((known >= 0) & (known <= FREE), 0, 1)).astype(np.uint8)
    factor = max(1, math.ceil(max(known.shape) / LONGEST))
    whole = np.pad(kinds, [(0, -size % factor) for size in kinds.shape], constant_values=1)
    high, wide = (size // factor for size in whole.shape)
    pixels = whole.reshape(high, factor, wide, factor).max(axis=(1, 3))  # the maximum preserves thin walls
    return {
        "image": "data:image/png;base64," + base64.b64encode(_png(pixels[::-1])).decode("ascii"),
        "corner": list(origin.outward(column * resolution, row * resolution)),
        "yaw": origin.yaw,
        "width": wide * factor * resolution,
        "height": high * factor * resolution,
    }


def known_part(cells: np.ndarray) -> Tuple[int, int, np.ndarray]:
    """Return the known part of a map (negative: unknown), after its first row and column; all if nothing is known."""
    rows, columns = (np.flatnonzero((cells >= 0).any(axis=axis)) for axis in (1, 0))
    if not len(rows):
        return 0, 0, cells
    return int(rows[0]), int(columns[0]), cells[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def _png(pixels: np.ndarray) -> bytes:
    """Return a PNG image of pixels (uint8, rows from the top), which are indices into PALETTE."""
    lines = np.pad(pixels, ((0, 0), (1, 0)))  # a line begins with its filter: none
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 3, 0, 0, 0)),
        (b"PLTE", bytes(value for colour in PALETTE for value in colour[:3])),
        (b"tRNS", bytes(colour[3] for colour in PALETTE)),
        (b"IDAT", zlib.compress(lines.tobytes(), 9)),
        (b"IEND", b""),
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks
    )
