"""The compiled evidence of rays: which cells they mark and clear.

Lengths are in cells, as in :mod:`rosoclingo.robot.navigation.compiled.clearance`.
"""

import math
from typing import NamedTuple

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import square_distance
from rosoclingo.robot.navigation.compiled.jit import jit

__all__ = ["Evidence", "Mapped", "Rules", "count_rays", "hits_apart"]


class Evidence(NamedTuple):
    """What rays have told of each cell so far.

    ``counts`` (uint8 H, W): hits and passes; ``marks`` (uint8 H, W): non-zero where something is; ``spots`` (uint8 H,
    W, 2): where in the cell it was hit, in 1/256 of the cell from its lower left.
    """

    counts: np.ndarray
    marks: np.ndarray
    spots: np.ndarray


class Mapped(NamedTuple):
    """What is ``occupied`` (uint8 H, W), and each cell's ``clearance`` (float32 H, W), the distance from that."""

    occupied: np.ndarray
    clearance: np.ndarray


class Rules(NamedTuple):
    """How rays count.

    A hit counts for ``gain``, thrice that in a cell that is marked, to ``limit`` at most; from ``sure`` on a cell is
    marked. Hits no further than ``known`` from what is mapped are left out. A ray clears what it passes no further than
    ``near``, or half of what is between two rays ``spacing`` rad apart.
    """

    gain: int
    limit: int
    sure: int
    known: float
    near: float
    spacing: float


@jit
def count_rays(evidence, mapped, x, y, angles, lengths, hits, rules):
    """Count what rays from (x, y) crossed and hit, and mark and clear by that.

    A cell's count goes up where a ray ends at the spot, if it ``hits`` (bool n) there. It goes down by 1 for each ray
    that crosses the cell before its ``lengths`` end and passes the spot: what fills a part of a cell only is not
    cleared by what passes beside it, and what noise scatters over a cell does not outweigh what passes.
    A mark is set where the count reaches ``rules.sure``, cleared where it comes down to 0, and else stays: noise does
    not set and clear a cell in turns. Returns the window (row0, row1, column0, column1; half-open)
    of the marks changed, empty (0, 0, 0, 0) where none was.
    """
    height, width = evidence.marks.shape
    low_r, high_r, low_c, high_c = height, -1, width, -1
    for i in range(angles.shape[0]):
        r0, r1, c0, c1 = _clear_along(evidence, x, y, angles[i], lengths[i], rules)
        low_r, high_r, low_c, high_c = min(low_r, r0), max(high_r, r1), min(low_c, c0), max(high_c, c1)
    for i in range(angles.shape[0]):
        if not hits[i]:
            continue
        dx, dy = math.cos(angles[i]), math.sin(angles[i])
        px, py = x + dx * lengths[i], y + dy * lengths[i]
        column, row = int(math.floor(px)), int(math.floor(py))
        if not (0 <= row < height and 0 <= column < width) or _is_next(mapped, px, py, rules.known):
            continue
        again = evidence.counts[row, column] == 0 or _passes(
            column - x, row - y, dx, dy, evidence.spots[row, column], rules.near, rules.spacing
        )
        if _hit(evidence, row, column, px - column, py - row, rules, again):
            low_r, high_r = min(low_r, row), max(high_r, row)
            low_c, high_c = min(low_c, column), max(high_c, column)
    if high_r < 0:
        return 0, 0, 0, 0
    return low_r, high_r + 1, low_c, high_c + 1


@jit
def _clear_along(evidence, x, y, angle, length, rules):
    """Count a ray where it crosses cells; return the first and last row and column of the marks cleared."""
    counts, marks, spots = evidence
    height, width = marks.shape
    low_r, high_r, low_c, high_c = height, -1, width, -1
    dx, dy = math.cos(angle), math.sin(angle)
    column, row = int(math.floor(x)), int(math.floor(y))
    last_c, last_r = int(math.floor(x + dx * length)), int(math.floor(y + dy * length))
    step_c, step_r = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    per_c = abs(1.0 / dx) if dx != 0.0 else np.inf
    per_r = abs(1.0 / dy) if dy != 0.0 else np.inf
    next_c = ((column + 1 - x) if dx > 0 else (x - column)) * per_c if dx != 0.0 else np.inf
    next_r = ((row + 1 - y) if dy > 0 else (y - row)) * per_r if dy != 0.0 else np.inf
    for _ in range(abs(last_c - column) + abs(last_r - row)):
        if (
            0 <= row < height
            and 0 <= column < width
            and counts[row, column]
            and _passes(column - x, row - y, dx, dy, spots[row, column], rules.near, rules.spacing)
        ):
            counts[row, column] -= 1
            if counts[row, column] == 0 and marks[row, column]:
                marks[row, column] = 0
                low_r, high_r = min(low_r, row), max(high_r, row)
                low_c, high_c = min(low_c, column), max(high_c, column)
        if next_c < next_r:
            next_c, column = next_c + per_c, column + step_c
        else:
            next_r, row = next_r + per_r, row + step_r
    return low_r, high_r, low_c, high_c


@jit
def _hit(evidence, row, column, x, y, rules, again):
    """Note a hit at (x, y; 0 .. 1) in a cell, count it if it is at the spot ``again``; tell whether it marks it."""
    counts, marks, spots = evidence
    _note(spots[row, column], x, y, counts[row, column] == 0)
    if not again:
        return False
    # It takes fewer hits to stay marked than to become so: else noise would open and close a passage in turns.
    gain = 3 * rules.gain if marks[row, column] else rules.gain
    counts[row, column] = min(counts[row, column] + gain, rules.limit)
    if counts[row, column] < rules.sure or marks[row, column]:
        return False
    marks[row, column] = 1
    return True


@jit
def _is_next(mapped, x, y, reach):
    """Tell whether a point on the grid is no further than ``reach`` from what is mapped."""
    if mapped.clearance[int(y), int(x)] > reach + 0.75:
        return False
    return square_distance(mapped.occupied, x, y, reach + 1.0) <= reach


@jit
def _passes(x, y, dx, dy, spot, near, spacing):
    """Tell whether a ray from the origin towards (dx, dy) passes the ``spot`` in a cell at (x, y)."""
    x, y = x + (spot[0] + 0.5) / 256.0, y + (spot[1] + 0.5) / 256.0
    return abs(x * dy - y * dx) <= max(near, 0.5 * spacing * math.hypot(x, y))


@jit
def _note(spot, x, y, first) -> None:
    """Move a spot towards where in its cell (0 .. 1) something was hit: the first time all the way, then a part."""
    for axis in range(2):
        at = min(255.0, 256.0 * (x if axis == 0 else y))
        spot[axis] = np.uint8(at if first else spot[axis] + 0.25 * (at - spot[axis]))


@jit
def hits_apart(known, x, y, angles, ranges, hits, near, apart):
    """Return the points (float64 n, 2) that rays from (x, y) ``hit``, more than ``apart`` from what is ``known``.

    Only those closer than ``near``, and on the grid.
    """
    height, width = known.occupied.shape
    points = np.empty((angles.shape[0], 2))
    size = 0
    for i in range(angles.shape[0]):
        if hits[i] and ranges[i] < near:
            px, py = x + ranges[i] * math.cos(angles[i]), y + ranges[i] * math.sin(angles[i])
            column, row = int(math.floor(px)), int(math.floor(py))
            if 0 <= row < height and 0 <= column < width and not _is_next(known, px, py, apart):
                points[size, 0], points[size, 1] = px, py
                size += 1
    return points[:size].copy()
