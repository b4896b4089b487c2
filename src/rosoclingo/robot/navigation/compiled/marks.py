"""Marking and clearing of cells by laser scans, compiled by numba.

Lengths are in cells, as in :mod:`rosoclingo.robot.navigation.compiled.clearance`.
"""

import math

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import ray_start, square_distance
from rosoclingo.robot.navigation.compiled.jit import jit

# A scan hits a cell if one in PART of the rays in it ends there; one in PART_MARKED for a cell that is marked already.
PART, PART_MARKED = 4, 10
# A hit adds GAIN to the count of a cell, a pass subtracts 1. The cell is marked at SURE and cleared at 0.
GAIN, SURE, LIMIT = 2, 4, 6


@jit
def count_scan(counts, occupied, mapped, clearance, x, y, angles, lengths, hits, known):
    """Count the hits and passes of a scan from (x, y), and mark and clear cells accordingly.

    ``counts``, ``occupied``: uint8 (H, W). ``mapped`` cells (uint8 H, W) stay occupied, and rays that end within
    ``known`` of them do not count as hits; ``clearance`` (float32) is their distance field. ``hits``: bool (n).
    Returns the window (row0, row1, column0, column1; half-open) of changed cells, (0, 0, 0, 0) if there are none.
    """
    height, width = occupied.shape
    reach = lengths.max() + 1.0 if lengths.shape[0] else 0.0
    top, left = max(0, int(y - reach)), max(0, int(x - reach))
    rows, columns = min(height, int(y + reach) + 1) - top, min(width, int(x + reach) + 1) - left
    ended = np.zeros((max(0, rows), max(0, columns)), np.int32)
    passed = np.zeros(ended.shape, np.int32)
    for i in range(angles.shape[0]):
        dx, dy = math.cos(angles[i]), math.sin(angles[i])
        _pass(passed, x - left, y - top, dx, dy, lengths[i])
        px, py = x + dx * lengths[i], y + dy * lengths[i]
        if hits[i] and 0.0 <= px < width and 0.0 <= py < height and not _is_next(mapped, clearance, px, py, known):
            ended[int(py) - top, int(px) - left] += 1
    low_r, high_r, low_c, high_c = height, 0, width, 0
    for r in range(ended.shape[0]):
        for c in range(ended.shape[1]):
            row, column = r + top, c + left
            if mapped[row, column] or ended[r, c] + passed[r, c] == 0:
                continue
            if _is_changed(counts, occupied, row, column, ended[r, c], passed[r, c]):
                low_r, high_r = min(low_r, row), max(high_r, row + 1)
                low_c, high_c = min(low_c, column), max(high_c, column + 1)
    return (low_r, high_r, low_c, high_c) if high_r else (0, 0, 0, 0)


@jit
def _pass(passed, x, y, dx, dy, length):
    """Count a ray in all cells that it crosses, except the last."""
    height, width = passed.shape
    column, row, step_c, step_r, per_c, per_r, next_c, next_r = ray_start(x, y, dx, dy)
    last_c, last_r = int(math.floor(x + dx * length)), int(math.floor(y + dy * length))
    for _ in range(abs(last_c - column) + abs(last_r - row)):
        if 0 <= row < height and 0 <= column < width:
            passed[row, column] += 1
        if next_c < next_r:
            next_c, column = next_c + per_c, column + step_c
        else:
            next_r, row = next_r + per_r, row + step_r


@jit
def _is_changed(counts, occupied, row, column, ended, passed):
    """Update the count of a cell. Return whether this marks or clears the cell."""
    count, marked = int(counts[row, column]), occupied[row, column] > 0
    if ended * (PART_MARKED if marked else PART) >= ended + passed:
        count = min(LIMIT, count + GAIN)
    elif passed:
        count = max(0, count - 1)
    counts[row, column] = count
    if marked == (count > 0 if marked else count >= SURE):
        return False
    occupied[row, column] = not marked
    return True


@jit
def _is_next(occupied, clearance, x, y, reach):
    """Return whether a point on the grid is within ``reach`` of an occupied cell."""
    if clearance[int(y), int(x)] > reach + 0.75:
        return False
    return square_distance(occupied, x, y, reach + 1.0) <= reach


@jit
def hits_apart(occupied, clearance, x, y, angles, ranges, hits, near, apart):
    """Return the end points (float64 n, 2) of rays more than ``apart`` from ``occupied`` cells.

    Rays start at (x, y). Points must be closer than ``near``, on the grid, and have such a point on both sides:
    isolated points are noise.
    """
    height, width = occupied.shape
    count = angles.shape[0]
    points, found = np.empty((count, 2)), np.zeros(count + 2, dtype=np.bool_)
    for i in range(count):
        if hits[i] and ranges[i] < near:
            px, py = x + ranges[i] * math.cos(angles[i]), y + ranges[i] * math.sin(angles[i])
            points[i, 0], points[i, 1] = px, py
            found[i + 1] = 0.0 <= px < width and 0.0 <= py < height and not _is_next(occupied, clearance, px, py, apart)
    return points[found[:-2] & found[1:-1] & found[2:]]
