"""The compiled search of the grid planner: A* over cells, and the straightening of what it finds.

Lengths are in cells, as in :mod:`rosoclingo.navigation.compiled`.
"""

import math

import numpy as np

from rosoclingo.navigation.compiled import jit, square_distance

__all__ = ["find_cells", "nearest_clear_cell", "straighten", "tighten"]

DIAGONAL = math.sqrt(2.0)
# The search overestimates what is left by that factor: the way found may be that much dearer than the cheapest.
EAGER = 1.003
# The steps to the eight cells around one.
ROWS, COLUMNS = np.array([0, 0, 1, -1, 1, 1, -1, -1]), np.array([1, -1, 0, 0, 1, -1, 1, -1])
LENGTHS = np.hypot(ROWS, COLUMNS)


@jit
def _price(clearance, comfort, weight):
    """Return what a cell of travel costs where things are ``clearance`` away: 1, and more nearer than ``comfort``."""
    if clearance >= comfort:
        return 1.0
    return 1.0 + weight * (1.0 - clearance / comfort)


@jit
def _octile(row, column, goal_row, goal_column):
    """Return a little more than the length of the shortest 8-connected way on an empty grid."""
    dr, dc = abs(row - goal_row), abs(column - goal_column)
    return EAGER * (max(dr, dc) + (DIAGONAL - 1.0) * min(dr, dc))


@jit
def _push(keys, items, size, key, item):
    """Add to the binary heap; return its new size."""
    i = size
    while i > 0:
        parent = (i - 1) >> 1
        if keys[parent] <= key:
            break
        keys[i], items[i] = keys[parent], items[parent]
        i = parent
    keys[i], items[i] = key, item
    return size + 1


@jit
def _pop(keys, items, size):
    """Take the least off the binary heap; the item then is in ``items[size - 1]``. Return the new size."""
    size -= 1
    item, key, last = items[0], keys[size], items[size]
    i = 0
    child = 1
    while child < size:
        if child + 1 < size and keys[child + 1] < keys[child]:
            child += 1
        if keys[child] >= key:
            break
        keys[i], items[i] = keys[child], items[child]
        i = child
        child = 2 * i + 1
    keys[i], items[i] = key, last
    items[size] = item
    return size


@jit
def find_cells(clearance, least, comfort, weight, start_row, start_column, goal_row, goal_column):
    """Return the cheapest 8-connected way as an int32 array (n, 2) of (row, column), empty where there is none.

    Uses cells that are ``least`` or more clear; start and goal must be such cells. A closed cell has -1.
    """
    height, width = clearance.shape
    total = height * width
    costs = np.full(total, np.inf, dtype=np.float32)
    origins = np.full(total, -1, dtype=np.int32)
    keys = np.empty(4 * (height + width) + 64, dtype=np.float32)
    items = np.empty(keys.shape[0], dtype=np.int32)
    start, goal = start_row * width + start_column, goal_row * width + goal_column
    costs[start] = 0.0
    size = _push(keys, items, 0, np.float32(_octile(start_row, start_column, goal_row, goal_column)), np.int32(start))
    found = False
    while size > 0:
        key = keys[0]
        size = _pop(keys, items, size)
        here = items[size]
        if here == goal:
            found = True
            break
        row, column = here // width, here % width
        cost = costs[here]
        if key > cost + _octile(row, column, goal_row, goal_column) + 1e-2:
            continue
        price = _price(clearance[row, column], comfort, weight)
        if size + 8 >= keys.shape[0]:
            keys, items = _grown_keys(keys), _grown_items(items)
        for k in range(8):
            r, c = row + ROWS[k], column + COLUMNS[k]
            if r < 0 or c < 0 or r >= height or c >= width:
                continue
            room = clearance[r, c]
            if room < least:
                continue
            there = r * width + c
            old = costs[there]
            if cost + LENGTHS[k] >= old:
                continue
            new = np.float32(cost + 0.5 * LENGTHS[k] * (price + _price(room, comfort, weight)))
            if new < old:
                costs[there], origins[there] = new, here
                key = np.float32(new + _octile(r, c, goal_row, goal_column))
                size = _push(keys, items, size, key, np.int32(there))
    if not found:
        return np.empty((0, 2), dtype=np.int32)
    return _traced(origins, goal, width)


@jit
def _grown_keys(keys):
    grown = np.empty(2 * keys.shape[0], dtype=np.float32)
    grown[: keys.shape[0]] = keys
    return grown


@jit
def _grown_items(items):
    grown = np.empty(2 * items.shape[0], dtype=np.int32)
    grown[: items.shape[0]] = items
    return grown


@jit
def _traced(origins, goal, width):
    """Return the way to ``goal`` that the search left in ``origins``."""
    count, here = 0, goal
    while here >= 0:
        count, here = count + 1, origins[here]
    cells = np.empty((count, 2), dtype=np.int32)
    here = goal
    for i in range(count - 1, -1, -1):
        cells[i, 0], cells[i, 1] = here // width, here % width
        here = origins[here]
    return cells


@jit
def _segment_price(clearance, x0, y0, x1, y1, comfort, weight):
    """Return what a straight segment costs, sampled twice a cell."""
    length = math.hypot(x1 - x0, y1 - y0)
    count = int(2.0 * length) + 1
    total = 0.0
    for i in range(count):
        part = (i + 0.5) / count
        total += _price(clearance[int(y0 + (y1 - y0) * part), int(x0 + (x1 - x0) * part)], comfort, weight)
    return total * length / count


@jit
def line_is_clear(clearance, occupied, x0, y0, x1, y1, radius):
    """Tell whether a segment (in cells) keeps ``radius`` away from what is occupied, and off what is closed.

    Distances are exact (looked at every tenth of a cell) where it is tight, and bounded by the field elsewhere.
    """
    height, width = clearance.shape
    length = math.hypot(x1 - x0, y1 - y0)
    done = 0.0
    while True:
        part = done / length if length > 0.0 else 0.0
        x, y = x0 + (x1 - x0) * part, y0 + (y1 - y0) * part
        column, row = math.floor(x), math.floor(y)
        if not (0 <= row < height and 0 <= column < width):
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
        done = min(length, done + max(spare, 0.1))


@jit
def straighten(points, clearance, occupied, radius, comfort, weight):
    """Return the points (float64 n, 2; x, y) that are left when straight lines replace what they can.

    A line replaces a part of the way when it keeps ``radius`` from what is ``occupied`` and is no dearer.
    """
    count = points.shape[0]
    cost = np.zeros(count)
    for i in range(1, count):
        cost[i] = cost[i - 1] + _segment_price(
            clearance, points[i - 1, 0], points[i - 1, 1], points[i, 0], points[i, 1], comfort, weight
        )
    kept = np.empty((count, 2))
    kept[0] = points[0]
    size, here = 1, 0
    while here < count - 1:
        there, stride = here + 1, 1
        while stride > 0:
            probe = min(count - 1, there + stride)
            if probe > there and _shortcut(
                clearance, occupied, points[here], points[probe], radius, comfort, weight, cost[probe] - cost[here]
            ):
                there, stride = probe, stride * 2
            else:
                stride //= 2
        kept[size] = points[there]
        size, here = size + 1, there
    return kept[:size].copy()


@jit
def _shortcut(clearance, occupied, start, end, radius, comfort, weight, cost):
    """Tell whether the line between two points is clear and costs no more than ``cost``."""
    x0, y0, x1, y1 = start[0], start[1], end[0], end[1]
    if not line_is_clear(clearance, occupied, x0, y0, x1, y1, radius):
        return False
    return _segment_price(clearance, x0, y0, x1, y1, comfort, weight) <= cost * 1.0005 + 1e-6


@jit
def tighten(points, clearance, occupied, radius, comfort, weight, rounds):
    """Pull a way (float64 n, 2) tight: move inner points towards the line between their neighbours where that pays."""
    for _ in range(rounds):
        for i in range(1, points.shape[0] - 1):
            a, b = points[i - 1], points[i + 1]
            x, y = points[i, 0], points[i, 1]
            dx, dy = b[0] - a[0], b[1] - a[1]
            square = dx * dx + dy * dy
            t = 0.5
            if square > 0.0:
                t = min(1.0, max(0.0, ((x - a[0]) * dx + (y - a[1]) * dy) / square))
            aim_x, aim_y = a[0] + t * dx, a[1] + t * dy
            now = _segment_price(clearance, a[0], a[1], x, y, comfort, weight)
            now += _segment_price(clearance, x, y, b[0], b[1], comfort, weight)
            part = 1.0
            while part > 0.05:
                nx, ny = x + part * (aim_x - x), y + part * (aim_y - y)
                there = _segment_price(clearance, a[0], a[1], nx, ny, comfort, weight)
                there += _segment_price(clearance, nx, ny, b[0], b[1], comfort, weight)
                if (
                    there < now
                    and line_is_clear(clearance, occupied, a[0], a[1], nx, ny, radius)
                    and line_is_clear(clearance, occupied, nx, ny, b[0], b[1], radius)
                ):
                    points[i, 0], points[i, 1] = nx, ny
                    break
                part *= 0.5


@jit
def nearest_clear_cell(clearance, least, row, column, reach):
    """Return the (row, column) nearest to a cell, within ``reach``, that is ``least`` clear; else (-1, -1)."""
    height, width = clearance.shape
    best, best_row, best_column = (reach + 1e-6) ** 2, -1, -1
    span = int(reach)
    for r in range(max(0, row - span), min(height, row + span + 1)):
        for c in range(max(0, column - span), min(width, column + span + 1)):
            away = (r - row) ** 2 + (c - column) ** 2
            if away < best and clearance[r, c] >= least:
                best, best_row, best_column = away, r, c
    return best_row, best_column
