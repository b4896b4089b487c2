"""Fast marching method: the costs of the cheapest paths from all cells to a goal, compiled by numba.

See J. A. Sethian, "A fast marching level set method for monotonically advancing fronts" (1996). navfn uses the same
method. Lengths are in cells, and cell (row, column) has its centre at these coordinates.
"""

import heapq
import math

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import square_distance
from rosoclingo.robot.navigation.compiled.jit import jit

STEP = 0.5  # cells: length of a step of the descent
TURNS = 6  # steps within one cell after which the descent moves to the lowest neighbour
STEEP = 1e-9
NUDGE = 1e-3
AROUND = ((1, 0), (-1, 0), (0, 1), (0, -1))
DIAGONALS = ((1, 1), (1, -1), (-1, 1), (-1, -1))


@jit
def march(costs, row, column, to_row, to_column, stop):
    """Return the cost of the cheapest path from each cell to (row, column) (float64 H, W), inf if there is none.

    ``costs``: float32 (H, W), at least 1 per cell length; inf for obstacles. The search is directed towards (to_row,
    to_column) and ends there, so that other cells can have no value; with ``to_row`` -1 it covers all cells. It is
    cancelled by setting ``stop`` (bool, one item).
    """
    height, width = costs.shape
    found = np.full((height, width), np.inf)
    done = np.zeros((height, width), dtype=np.bool_)
    found[row, column] = 0.0
    front = [(0.0, row, column)]
    while len(front) > 0 and not stop[0]:
        _, r, c = heapq.heappop(front)
        if done[r, c]:
            continue
        done[r, c] = True
        if r == to_row and c == to_column:
            break
        for dr, dc in AROUND:
            i, j = r + dr, c + dc
            if 0 <= i < height and 0 <= j < width and not done[i, j] and costs[i, j] < np.inf:
                value = _cost_at(found, i, j, costs[i, j])
                if value < found[i, j]:
                    found[i, j] = value
                    left = math.hypot(i - to_row, j - to_column) if to_row >= 0 else 0.0
                    heapq.heappush(front, (value + left, i, j))
    return found


@jit
def _cost_at(found, row, column, cost):
    """Return the cost of a cell from those of its neighbours, for a straight front."""
    height, width = found.shape
    a = min(found[row - 1, column] if row > 0 else np.inf, found[row + 1, column] if row + 1 < height else np.inf)
    b = min(found[row, column - 1] if column > 0 else np.inf, found[row, column + 1] if column + 1 < width else np.inf)
    a, b = min(a, b), max(a, b)
    if b - a >= cost:
        return a + cost
    return 0.5 * (a + b + math.sqrt(2.0 * cost * cost - (a - b) * (a - b)))


@jit
def descend(found, row, column, last_row, last_column):
    """Return the path (float64 n, 2; row, column) of steepest descent from a point to the cell with value 0.

    If the gradient leads upwards or vanishes, the path continues in the lowest neighbouring cell, so that it
    terminates.
    """
    points = [(row, column)]
    turns = 0
    r, c = int(math.floor(row + 0.5)), int(math.floor(column + 0.5))
    while math.hypot(row - last_row, column - last_column) > 1.0:
        down, right = _slope(found, row, column)
        steep = math.hypot(down, right)
        next_row, next_column = row, column
        if steep > STEEP:
            next_row, next_column = row - STEP * down / steep, column - STEP * right / steep
        i, j = int(math.floor(next_row + 0.5)), int(math.floor(next_column + 0.5))
        turns = turns + 1 if i == r and j == c else 0
        inside = 0 <= i < found.shape[0] and 0 <= j < found.shape[1]
        if steep <= STEEP or turns > TURNS or not inside or found[i, j] > found[r, c]:
            i, j = _lowest(found, r, c)
            if i == r and j == c:
                break
            next_row, next_column, turns = float(i), float(j), 0
        row, column, r, c = next_row, next_column, i, j
        points.append((row, column))
    points.append((last_row, last_column))
    return np.array(points)


@jit
def _lowest(found, row, column):
    """Return the lowest of a cell and its neighbours. Diagonal steps do not cut the corners of obstacles."""
    height, width = found.shape
    best_row, best_column = row, column
    for dr, dc in AROUND + DIAGONALS:
        i, j = row + dr, column + dc
        if not (0 <= i < height and 0 <= j < width) or max(found[i, column], found[row, j]) == np.inf:
            continue
        if found[i, j] < found[best_row, best_column]:
            best_row, best_column = i, j
    return best_row, best_column


@jit
def _slope(found, row, column):
    """Return the direction of ascent at a point, interpolated between the four cells around it."""
    height, width = found.shape
    top, left = int(math.floor(row)), int(math.floor(column))
    down = right = 0.0
    for i in range(max(top, 0), min(top + 2, height)):
        for j in range(max(left, 0), min(left + 2, width)):
            part = (1.0 - abs(row - i)) * (1.0 - abs(column - j))
            up = found[i - 1, j] if i > 0 else np.inf
            below = found[i + 1, j] if i + 1 < height else np.inf
            before = found[i, j - 1] if j > 0 else np.inf
            after = found[i, j + 1] if j + 1 < width else np.inf
            a, b = _growth(up, found[i, j], below), _growth(before, found[i, j], after)
            steep = math.hypot(a, b)
            if steep > 0.0:
                down += part * a / steep
                right += part * b / steep
    return down, right


@jit
def _growth(before, here, after):
    """Return the gradient along three cells; inf is higher than any other value."""
    if here == np.inf:
        return (1.0 if before < np.inf else 0.0) - (1.0 if after < np.inf else 0.0)
    return (here - before if before < np.inf else 0.0) + (after - here if after < np.inf else 0.0)


@jit
def ease(points, occupied, enough) -> None:
    """Move points (float64 n, 2; x, y) closer than ``enough`` to obstacles away from them, by at most half a cell.

    Fast marching only uses the centres of cells, and the middle of a narrow gap can lie between two of them.
    """
    for i in range(1, points.shape[0] - 1):
        x, y = points[i, 0], points[i, 1]
        away = square_distance(occupied, x, y, enough)
        dx = square_distance(occupied, x + NUDGE, y, enough + NUDGE) - away
        dy = square_distance(occupied, x, y + NUDGE, enough + NUDGE) - away
        length = math.hypot(dx, dy)
        part = min(0.5, enough - away)
        while length > 0.0 and part > 0.05:
            nx, ny = x + part * dx / length, y + part * dy / length
            if square_distance(occupied, nx, ny, enough) > away + 0.5 * part:
                points[i, 0], points[i, 1] = nx, ny
                break
            part *= 0.7


@jit
def thin(points, spacing, tolerance):
    """Remove redundant points of a path (float64 n, 2), keeping them at most ``spacing`` apart.

    Removed points are within ``tolerance`` of the line between their neighbours.
    """
    kept = [0]
    last = points.shape[0] - 1
    for i in range(1, last):
        first = kept[-1]
        dx, dy = points[i + 1, 0] - points[first, 0], points[i + 1, 1] - points[first, 1]
        length = math.hypot(dx, dy)
        needed = length > spacing
        for k in range(first + 1, i + 1):
            off = abs((points[k, 0] - points[first, 0]) * dy - (points[k, 1] - points[first, 1]) * dx)
            needed = needed or off > tolerance * length
        if needed:
            kept.append(i)
    if last > 0:
        kept.append(last)
    return points[np.array(kept)]
