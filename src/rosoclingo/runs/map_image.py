"""A map as a small image for pages, cropped to its known part and transparent where the floor is free."""

import base64
import math
import struct
import zlib
from typing import Any, Dict, Iterable, List, Tuple

#: The values of a map (nav_msgs/OccupancyGrid) up to which a cell is free, and from which it is occupied.
FREE, OCCUPIED = 25, 65

#: Limit of pixels of an image's longer side.
LONGEST = 2048

#: Red, green, blue and opacity of free, unknown and occupied cells.
PALETTE = ((255, 255, 255, 0), (128, 128, 128, 72), (52, 60, 74, 255))

_UNKNOWN = 255  # -1 as a byte; all negative values count as unknown
_NORMAL = bytes(value if value < 128 else _UNKNOWN for value in range(256))
_KINDS = bytes(0 if value <= FREE else 2 if OCCUPIED <= value < 128 else 1 for value in range(256))


def map_image(
    cells: Iterable[int], width: int, resolution: float, origin: Tuple[float, float, float]
) -> Dict[str, Any]:
    """Return a map (int8, rows of ``width`` cells from the origin on, -1 unknown) as an image for a page.

    ``origin`` is the pose of the first cell's corner (m, rad). The result has the image as a ``data:`` URL, its
    ``corner`` (x, y of its lower left, m), ``yaw`` (rad), ``width`` and ``height`` (m).
    """
    data = bytes(value & 255 for value in cells).translate(_NORMAL)
    row, column, known = _known([data[start : start + width] for start in range(0, len(data), width)])
    factor = max(1, math.ceil(max(len(known), len(known[0])) / LONGEST))
    kinds = _shrunk([one.translate(_KINDS) for one in known], factor)
    c, s = math.cos(origin[2]), math.sin(origin[2])
    along, across = column * resolution, row * resolution
    return {
        "image": "data:image/png;base64," + base64.b64encode(_png(kinds[::-1])).decode("ascii"),
        "corner": [origin[0] + c * along - s * across, origin[1] + s * along + c * across],
        "yaw": origin[2],
        "width": len(kinds[0]) * factor * resolution,
        "height": len(kinds) * factor * resolution,
    }


def _known(rows: List[bytes]) -> Tuple[int, int, List[bytes]]:
    """Return the known part with its first row and column; the whole map if nothing is known."""
    unknown = bytes([_UNKNOWN])
    filled = [number for number, row in enumerate(rows) if row.strip(unknown)]
    if not filled:
        return 0, 0, rows
    inside = rows[filled[0] : filled[-1] + 1]
    left = min(len(row) - len(row.lstrip(unknown)) for row in inside)
    right = max(len(row.rstrip(unknown)) for row in inside)
    return filled[0], left, [row[left:right] for row in inside]


def _shrunk(rows: List[bytes], factor: int) -> List[bytes]:
    """Merge blocks of cells into one cell each, preserving thin walls."""
    if factor == 1:
        return rows
    width, unknown = len(rows[0]) + -len(rows[0]) % factor, b"\1"
    rows = [row.ljust(width, unknown) for row in rows]
    rows += [unknown * width] * (-len(rows) % factor)
    lower = [bytes(map(max, *rows[at : at + factor])) for at in range(0, len(rows), factor)]
    return [bytes(map(max, *(row[at::factor] for at in range(factor)))) for row in lower]


def _png(rows: List[bytes]) -> bytes:
    """Return a PNG image of rows from the top, with indices into PALETTE."""
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 3, 0, 0, 0)),
        (b"PLTE", bytes(value for colour in PALETTE for value in colour[:3])),
        (b"tRNS", bytes(colour[3] for colour in PALETTE)),
        (b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows), 9)),
        (b"IEND", b""),
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data)) for name, data in chunks
    )
