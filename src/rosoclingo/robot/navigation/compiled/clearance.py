"""Clearance, distances and ray casting on grids, compiled by numba.

All arrays are C-contiguous. Lengths are in *cells* unless noted otherwise: x = (metres - origin) / resolution. Cell
(row, column) is the square [column, column + 1] x [row, row + 1].
"""

import math

import numpy as np

from rosoclingo.robot.navigation.compiled.jit import jit

HALF_DIAGONAL = math.sqrt(0.5)


@jit
def update_clearance(occupied, reach, row0, row1, column0, column1, out) -> None:
    """Write the clearance of each cell into ``out[row0:row1, column0:column1]``.

    The clearance is the distance from the cell's centre to the nearest occupied square, at most ``reach``; -0.5 for an
    occupied cell. ``occupied``: uint8 (H, W), non-zero is occupied; ``out``: float32 (H, W).
    """
    height, _width = occupied.shape
    span = math.ceil(reach) + 1
    top = max(0, row0 - span)
    rows = min(height, row1 + span) - top
    columns = column1 - column0
    gaps = np.full((rows, columns), reach * reach, dtype=np.float32)
    for r in range(rows):
        _row_gaps(occupied[top + r], reach, span, column0, column1, gaps[r])
    for r in range(row0, row1):
        for c in range(columns):
            if occupied[r, column0 + c]:
                out[r, column0 + c] = -0.5
                continue
            best = gaps[r - top, c]
            for d in range(1, span + 1):
                down = (d - 0.5) * (d - 0.5)
                if down >= best:
                    break
                if r - d >= top:
                    best = min(best, gaps[r - d - top, c] + down)
                if r + d < top + rows:
                    best = min(best, gaps[r + d - top, c] + down)
            out[r, column0 + c] = math.sqrt(best)


@jit
def _row_gaps(row, reach, span, column0, column1, out) -> None:
    """Write the squared distances of cell centres to the nearest occupied cell within one row."""
    width = row.shape[0]
    limit = reach * reach
    last = -1000000
    for c in range(max(0, column0 - span), column1):
        if row[c]:
            last = c
        if c >= column0:
            gap = max(c - last - 0.5, 0.0)
            out[c - column0] = min(limit, gap * gap)
    last = 1000000
    for c in range(min(width, column1 + span) - 1, column0 - 1, -1):
        if row[c]:
            last = c
        if c < column1:
            gap = max(last - c - 0.5, 0.0)
            out[c - column0] = min(out[c - column0], np.float32(gap * gap))


@jit
def ray_start(x, y, dx, dy):
    """Return the first cell of a ray and, each for columns and rows, its direction, and where it enters the next cells.

    The walk of Amanatides and Woo (1987): (column, row), steps (1 or -1), distances between entries, next entries.
    """
    column, row = int(math.floor(x)), int(math.floor(y))
    per_c = abs(1.0 / dx) if dx != 0.0 else np.inf
    per_r = abs(1.0 / dy) if dy != 0.0 else np.inf
    next_c = ((column + 1 - x) if dx > 0 else (x - column)) * per_c if dx != 0.0 else np.inf
    next_r = ((row + 1 - y) if dy > 0 else (y - row)) * per_r if dy != 0.0 else np.inf
    return column, row, (1 if dx > 0 else -1), (1 if dy > 0 else -1), per_c, per_r, next_c, next_r


@jit
def ray_length(occupied, x, y, dx, dy, reach):
    """Return the length of a ray from (x, y) to the first occupied cell, at most ``reach``.

    The direction (dx, dy) has length 1. A ray that starts in an occupied cell has length 0, one that leaves the grid
    has length ``reach``. The walk visits every crossed cell, so the length is exact.
    """
    height, width = occupied.shape
    column, row, step_c, step_r, per_c, per_r, next_c, next_r = ray_start(x, y, dx, dy)
    at = 0.0
    while at < reach:
        if 0 <= row < height and 0 <= column < width and occupied[row, column]:
            return at
        if next_c < next_r:
            at, next_c, column = next_c, next_c + per_c, column + step_c
        else:
            at, next_r, row = next_r, next_r + per_r, row + step_r
    return reach


@jit
def square_distance(occupied, x, y, reach):
    """Return the distance of a point to the nearest occupied square, at most ``reach``."""
    height, width = occupied.shape
    best = reach * reach
    for row in range(max(0, int(y - reach)), min(height, int(y + reach) + 1)):
        for column in range(max(0, int(x - reach)), min(width, int(x + reach) + 1)):
            if occupied[row, column]:
                dx = max(0.0, max(column - x, x - column - 1.0))
                dy = max(0.0, max(row - y, y - row - 1.0))
                best = min(best, dx * dx + dy * dy)
    return math.sqrt(best)


@jit
def update_open(clearance, occupied, closed, radius, row0, row1, column0, column1, out) -> None:
    """Write into ``out[row0:row1, column0:column1]`` (uint8 H, W) whether a disc of ``radius`` fits into each cell.

    It fits if the centre, a corner or the middle of an edge has that distance from ``occupied`` cells: the narrowest
    point of a gap is one of these. Cells that are ``closed`` (bool H, W) are never open.
    """
    for row in range(row0, row1):
        for column in range(column0, column1):
            room = clearance[row, column]
            fits = room >= radius
            if not fits and room + HALF_DIAGONAL >= radius:
                for k in range(9):
                    x, y = column + 0.5 * (k % 3), row + 0.5 * (k // 3)
                    fits = fits or square_distance(occupied, x, y, radius + 1.0) >= radius
            out[row, column] = fits and not closed[row, column]
