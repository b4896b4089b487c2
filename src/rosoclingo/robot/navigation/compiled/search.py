"""The compiled search of the grid planner: A* over cells, led by landmarks where there are some.

A landmark is a cell from which the cost of travel to all others is known. The way between two cells costs at least the
difference of what they cost from a landmark (A. Goldberg, C. Harrelson: Computing the shortest path, 2005). What the
laser marks only makes ways cost more, so costs on the map alone serve the search on any costmap of it.
Lengths are in cells, as in :mod:`rosoclingo.robot.navigation.compiled.clearance`.
"""

import math
from typing import Optional

import numpy as np

from rosoclingo.robot.navigation.compiled.jit import jit
from rosoclingo.robot.navigation.compiled.places import NOWHERE, OPEN, line_is_clear, place_of

__all__ = ["cell_cost", "find_cells", "spread"]

DIAGONAL, KNIGHT = math.sqrt(2.0), math.sqrt(5.0)
# Weighted A*: the search overestimates what is left by 1 + EPSILON, so that the way found may cost that much more.
EPSILON = 0.003
ACTIVE = 6  # landmarks that lead one search: those that tell most of its two ends
# The steps to the eight cells around one, and those of a knight in chess.
ROWS = np.array([0, 0, 1, -1, 1, 1, -1, -1, 1, 1, -1, -1, 2, 2, -2, -2])
COLUMNS = np.array([1, -1, 0, 0, 1, -1, 1, -1, 2, -2, 2, -2, 1, -1, 1, -1])
AROUND = 8
PORTION = 100000  # cells that are looked at in one go: some 50 ms
LENGTHS = np.hypot(ROWS, COLUMNS)


@jit
def cell_cost(clearance, comfort, weight):
    """Return what a cell of travel costs where things are ``clearance`` away: 1, and more nearer than ``comfort``."""
    if clearance >= comfort:
        return 1.0
    return 1.0 + weight * (1.0 - clearance / comfort)


@jit
def _guides(costs, start, goal):
    """Return which landmarks tell most of the way between two cells, ACTIVE of them at most.

    ``costs``: float32 (landmarks, cells). Both cells must be reached, or neither, by each: see :func:`_apart`.
    """
    gains = np.empty(costs.shape[0])
    for k in range(costs.shape[0]):
        gains[k] = abs(costs[k, start] - costs[k, goal]) if costs[k, goal] < np.inf else -1.0
    best = np.argsort(-gains)[:ACTIVE]
    return best[gains[best] >= 0.0]


@jit
def _apart(costs, start, goal):
    """Tell whether a landmark reaches only one of two cells, so that no way joins them."""
    reached = 0
    for k in range(costs.shape[0]):
        reached += (costs[k, start] < np.inf) != (costs[k, goal] < np.inf)
    return reached > 0


@jit
def _left(row, column, goal_row, goal_column, there, goal, steps, costs, guides):
    """Return a little more than the least that the way from a cell to the goal can cost.

    By the shortest way on an empty grid, and by what the two cost from the landmarks that guide.
    """
    dr, dc = abs(row - goal_row), abs(column - goal_column)
    high, low = max(dr, dc), min(dr, dc)
    if steps == AROUND:
        least = high + (DIAGONAL - 1.0) * low
    elif high >= 2 * low:
        least = high + (KNIGHT - 2.0) * low
    else:
        least = (KNIGHT - DIAGONAL) * high + (2.0 * DIAGONAL - KNIGHT) * low
    for k in guides:
        least = max(least, abs(costs[k, there] - costs[k, goal]))
    return (1.0 + EPSILON) * least


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
def _leads(ground, row, column, k):
    """Tell whether the straight line from the place in a cell to that in the cell a step away is clear.

    A knight's step is where its ends and both cells between them are open: what is far enough from the middles of all
    four is far enough from the line.
    """
    places = ground.places
    r, c = row + ROWS[k], column + COLUMNS[k]
    if k >= AROUND:
        dr, dc = ROWS[k] // 2, COLUMNS[k] // 2
        between = places[row + dr, column + dc] == OPEN and places[r - dr, c - dc] == OPEN
        return between and places[row, column] == OPEN and places[r, c] == OPEN
    if places[row, column] == OPEN and places[r, c] == OPEN:
        return True
    x0, y0 = place_of(places, row, column)
    x1, y1 = place_of(places, r, c)
    return line_is_clear(ground, x0, y0, x1, y1, ground.radius)


def find_cells(
    ground, comfort, weight, start_row, start_column, goal_row, goal_column, steps, landmarks, wanted=None
) -> Optional[np.ndarray]:
    """Return the cheapest way as an int32 array (n, 2) of (row, column), empty where there is none.

    Uses cells in which there is a place; start and goal must be such cells. ``steps``: 8, to the cells around one, or
    16, a knight's too; landmarks are for 8.
    ``landmarks``: float32 (n, cells), n from 0 on: what each cell costs from each landmark, infinity beyond reach.
    ``wanted`` is asked between portions whether to go on; None is returned where it tells not to.
    """
    height, width = ground.clearance.shape
    start, goal = start_row * width + start_column, goal_row * width + goal_column
    guides = _guides_between(landmarks, start, goal)
    if guides is None:
        return np.empty((0, 2), dtype=np.int32)
    costs, origins, closed, keys, items = _begun(height, width, start)
    size = 1
    while size > 0 and not closed[goal]:
        if wanted is not None and not wanted():
            return None
        keys, items, size = _search(
            ground, comfort, weight, goal, steps, landmarks, guides, costs, origins, closed, keys, items, size, PORTION
        )
    return _traced(origins, goal, width) if closed[goal] else np.empty((0, 2), dtype=np.int32)


@jit
def _guides_between(landmarks, start, goal):
    """Return the landmarks that lead from start to goal; None where they tell that no way does."""
    if _apart(landmarks, start, goal):
        return None
    return _guides(landmarks, start, goal)


@jit
def _begun(height, width, start):
    """Return what a search works on: costs, origins, closed (all cells), and the heap, which holds the start."""
    total = height * width
    costs = np.full(total, np.inf, dtype=np.float32)
    origins = np.full(total, -1, dtype=np.int32)
    closed = np.zeros(total, dtype=np.uint8)
    keys = np.empty(4 * (height + width) + 64, dtype=np.float32)
    items = np.empty(keys.shape[0], dtype=np.int32)
    costs[start] = 0.0
    keys[0], items[0] = 0.0, start
    return costs, origins, closed, keys, items


@jit
def _search(ground, comfort, weight, goal, steps, landmarks, guides, costs, origins, closed, keys, items, size, most):
    """Go on with a search by at most ``most`` cells, until the goal is closed; return (keys, items, size) left."""
    clearance, places = ground.clearance, ground.places
    height, width = clearance.shape
    goal_row, goal_column = goal // width, goal % width
    while size > 0 and not closed[goal] and most > 0:
        size = _pop(keys, items, size)
        here = items[size]
        if closed[here]:
            continue
        most -= 1
        closed[here] = 1
        row, column = here // width, here % width
        cost = costs[here]
        own = cell_cost(clearance[row, column], comfort, weight)
        if size + steps >= keys.shape[0]:
            keys, items = _grown_keys(keys), _grown_items(items)
        for k in range(steps):
            r, c = row + ROWS[k], column + COLUMNS[k]
            if r < 0 or c < 0 or r >= height or c >= width or places[r, c] == NOWHERE:
                continue
            there = r * width + c
            if closed[there] or cost + LENGTHS[k] >= costs[there]:
                continue
            new = np.float32(cost + 0.5 * LENGTHS[k] * (own + cell_cost(clearance[r, c], comfort, weight)))
            if new < costs[there] and _leads(ground, row, column, k):
                costs[there], origins[there] = new, here
                key = np.float32(new + _left(r, c, goal_row, goal_column, there, goal, steps, landmarks, guides))
                size = _push(keys, items, size, key, np.int32(there))
    return keys, items, size


@jit
def spread(ground, comfort, weight, costs, keys, items, size, most):
    """Go on with the costs of travel from a landmark, by at most ``most`` cells; return (keys, items, size) left.

    ``costs``: float32 (cells), infinite but for the landmark's 0 at the beginning; then ``keys`` (float32) and
    ``items`` (int32) hold its 0 and its cell, and ``size`` is 1. It is done when ``size`` is 0.
    Cells without a place are given costs too, as what the laser sees may make them needed, but lead nowhere.
    """
    clearance, places = ground.clearance, ground.places
    height, width = clearance.shape
    while size > 0 and most > 0:
        key = keys[0]
        size = _pop(keys, items, size)
        here = items[size]
        cost = costs[here]
        if key > cost:
            continue
        most -= 1
        row, column = here // width, here % width
        own = cell_cost(clearance[row, column], comfort, weight)
        if size + AROUND >= keys.shape[0]:
            keys, items = _grown_keys(keys), _grown_items(items)
        for k in range(AROUND):
            r, c = row + ROWS[k], column + COLUMNS[k]
            if r < 0 or c < 0 or r >= height or c >= width:
                continue
            there = r * width + c
            new = np.float32(cost + 0.5 * LENGTHS[k] * (own + cell_cost(clearance[r, c], comfort, weight)))
            if new >= costs[there]:
                continue
            if places[r, c] == NOWHERE:
                costs[there] = new
            elif _leads(ground, row, column, k):
                costs[there] = new
                size = _push(keys, items, size, new, np.int32(there))
    return keys, items, size


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
