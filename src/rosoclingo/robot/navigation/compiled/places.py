"""Where in each cell a disc-shaped robot may stand, and which straight lines it may drive.

A cell is open when its middle is so clear that all steps to other open cells are clear too. Where that leaves no way,
as in a gap whose middle lies between two cells, a cell may have another place: the middle, a corner or the middle of
an edge. Between the corners and edges of occupied cells the narrowest place of a gap is one of these.
Lengths are in cells, as in :mod:`rosoclingo.robot.navigation.compiled.clearance`.
"""

import math
from typing import NamedTuple, Tuple

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import square_distance
from rosoclingo.robot.navigation.compiled.jit import jit

__all__ = ["Ground", "line_is_clear", "nearest_place", "place_of", "places_of", "update_places"]

# What ``places`` holds: NOWHERE, OPEN, or TIGHT + 3 * row + column of the place in half cells from the lower left.
NOWHERE, OPEN, TIGHT = 0, 1, 2
AROUND = 2  # so many cells around one are looked at to tell whether it is needed
SPAN = 2 * AROUND + 1
LEFT = sum(1 << (SPAN * row) for row in range(SPAN))  # the first column of the cells around, as bits
RIGHT = LEFT << (SPAN - 1)
INNER = sum(1 << (SPAN * row + column) for row in range(1, SPAN - 1) for column in range(1, SPAN - 1))
HALF_DIAGONAL = math.sqrt(0.5)


class Ground(NamedTuple):
    """What a planner plans on; all arrays (height, width).

    ``clearance``: float32, distance of each cell's centre from what is ``occupied`` (uint8); ``inland``: float32, from
    where no way may lead, as nobody knows what is there, below 0 in that; ``places``: uint8, made by
    :func:`update_places`; ``radius``: what a way keeps free.
    """

    clearance: np.ndarray
    occupied: np.ndarray
    inland: np.ndarray
    places: np.ndarray
    radius: float


@jit
def line_is_clear(ground, x0, y0, x1, y1, radius):
    """Tell whether a segment (in cells) keeps ``radius`` away from what is occupied, and off what nobody knows.

    Distances are exact (looked at every tenth of a cell) where it is tight, and bounded by the field elsewhere.
    """
    clearance, occupied, inland = ground.clearance, ground.occupied, ground.inland
    height, width = clearance.shape
    length = math.hypot(x1 - x0, y1 - y0)
    done = 0.0
    while True:
        part = done / length if length > 0.0 else 0.0
        x, y = x0 + (x1 - x0) * part, y0 + (y1 - y0) * part
        if not (0.0 <= x <= width and 0.0 <= y <= height):
            return False
        column, row = min(int(x), width - 1), min(int(y), height - 1)  # the edges of the map belong to it
        if inland[row, column] < 0.0:
            return False
        off_centre = math.hypot(x - column - 0.5, y - row - 0.5)
        spare = clearance[row, column] - off_centre - radius
        if spare < 0.0:
            if clearance[row, column] + off_centre < radius:
                return False
            spare = square_distance(occupied, x, y, radius + 0.5) - radius
            if spare < 0.0:
                return False
        if done >= length:
            return True
        done = min(length, done + max(min(spare, inland[row, column] - off_centre), 0.1))


@jit
def place_of(places, row, column) -> Tuple[float, float]:
    """Return the place (x, y) in a cell that has one."""
    if places[row, column] == OPEN:
        return column + 0.5, row + 0.5
    kind = places[row, column] - TIGHT
    return column + 0.5 * (kind % 3), row + 0.5 * (kind // 3)


@jit
def places_of(places, cells):
    """Return the places (float64 n, 2; x, y) in cells (n, 2; row, column) that have one."""
    found = np.empty(cells.shape)
    for i in range(cells.shape[0]):
        found[i, 0], found[i, 1] = place_of(places, np.int64(cells[i, 0]), np.int64(cells[i, 1]))
    return found


@jit
def update_places(ground, row0, row1, column0, column1) -> None:
    """Bring ``ground.places[row0:row1, column0:column1]`` up to date with clearance and occupancy."""
    clearance, inland, places, radius = ground.clearance, ground.inland, ground.places, ground.radius
    least = math.sqrt(radius * radius + 0.5)
    for row in range(row0, row1):
        for column in range(column0, column1):
            room = clearance[row, column]
            if inland[row, column] < 0.0:
                places[row, column] = NOWHERE
            elif room >= least:
                places[row, column] = OPEN
            elif room + HALF_DIAGONAL < radius or _is_needless(ground, row, column, least):
                places[row, column] = NOWHERE
            else:
                places[row, column] = _best_place(ground.occupied, row, column, radius)


@jit
def _best_place(occupied, row, column, radius):
    """Return what ``places`` holds for the clearest place of a cell."""
    best, kind = radius, -1
    for k in (4, 1, 3, 5, 7, 0, 2, 6, 8):  # the middle first, corners last
        room = square_distance(occupied, column + 0.5 * (k % 3), row + 0.5 * (k // 3), radius + 1.5)
        if room >= best and (kind < 0 or room > best + 1e-9):
            best, kind = room, k
    return NOWHERE if kind < 0 else TIGHT + kind


@jit
def _is_needless(ground, row, column, least):
    """Tell whether the ways past a cell that is not open are open without it.

    They are when the open cells around it hang together, unless a cell next to it has no open ones around itself.
    """
    clearance, inland, radius = ground.clearance, ground.inland, ground.radius
    height, width = clearance.shape
    free, tight = np.int64(0), np.int64(0)
    for r in range(max(0, row - AROUND), min(height, row + AROUND + 1)):
        for c in range(max(0, column - AROUND), min(width, column + AROUND + 1)):
            bit = 1 << (SPAN * (r - row + AROUND) + c - column + AROUND)
            if inland[r, c] < 0.0:
                continue
            if clearance[r, c] >= least:
                free |= bit
            elif clearance[r, c] + HALF_DIAGONAL >= radius:
                tight |= bit
    if tight & INNER & ~_spread(free):
        return False
    part = free & -free
    while True:
        more = _spread(part) & free
        if more == part:
            return part == free
        part = more


@jit
def _spread(bits):
    """Return the cells (bits) together with those next to them, of the ones around a cell."""
    bits |= (bits & ~LEFT) >> 1 | (bits & ~RIGHT) << 1
    return (bits | bits >> SPAN | bits << SPAN) & (1 << SPAN * SPAN) - 1


@jit
def nearest_place(ground, x, y, reach, direct):
    """Return the (row, column) of the place nearest to a point (cells), within ``reach``; (-1, -1) where none is.

    ``direct``: only one to which a straight line is clear.
    """
    places = ground.places
    height, width = places.shape
    row, column = math.floor(y), math.floor(x)
    span = int(reach) + 1
    best, best_row, best_column = reach + 1e-6, -1, -1
    for r in range(max(0, row - span), min(height, row + span + 1)):
        for c in range(max(0, column - span), min(width, column + span + 1)):
            if places[r, c] == NOWHERE:
                continue
            px, py = place_of(places, r, c)
            away = 0.0 if r == row and c == column and not direct else math.hypot(px - x, py - y)
            if away < best and not (direct and not line_is_clear(ground, x, y, px, py, ground.radius)):
                best, best_row, best_column = away, r, c
    return best_row, best_column
