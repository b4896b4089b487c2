"""The compiled fast marching method: how far the cells of a map are from one of them, where cells differ in cost.

After J. A. Sethian, "A fast marching level set method for monotonically advancing fronts" (1996). Lengths are in cells;
cell (row, column) has its middle there.
"""

import heapq
import math

import numpy as np

from rosoclingo.robot.navigation.compiled.jit import jit

__all__ = ["length_down", "march"]

STEP = 0.5  # of a way down, in cells
AROUND = ((1, 0), (-1, 0), (0, 1), (0, -1))


@jit
def march(costs, row, column):
    """Return what the cheapest way from each cell to one of them costs (float64 H, W), inf where there is none.

    ``costs``: float64 (H, W), of a way of the length of a cell, above 0; inf where there is none.
    """
    height, width = costs.shape
    found = np.full((height, width), np.inf)
    done = np.zeros((height, width), dtype=np.bool_)
    found[row, column] = 0.0
    front = [(0.0, row, column)]
    while len(front) > 0:
        _, r, c = heapq.heappop(front)
        if done[r, c]:
            continue
        done[r, c] = True
        for dr, dc in AROUND:
            i, j = r + dr, c + dc
            if 0 <= i < height and 0 <= j < width and not done[i, j] and costs[i, j] < np.inf:
                value = _cost_at(found, i, j, costs[i, j])
                if value < found[i, j]:
                    found[i, j] = value
                    heapq.heappush(front, (value, i, j))
    return found


@jit
def _cost_at(found, row, column, cost):
    """Return the cost of a cell by those of its neighbours, where a straight front goes over it."""
    height, width = found.shape
    a = min(found[row - 1, column] if row > 0 else np.inf, found[row + 1, column] if row + 1 < height else np.inf)
    b = min(found[row, column - 1] if column > 0 else np.inf, found[row, column + 1] if column + 1 < width else np.inf)
    a, b = min(a, b), max(a, b)
    if b - a >= cost:
        return a + cost
    return 0.5 * (a + b + math.sqrt(2.0 * cost * cost - (a - b) * (a - b)))


@jit
def length_down(found, row, column, last_row, last_column):
    """Return the length of the way down from a point to where ``found`` is 0; nan where it leads nowhere."""
    height, width = found.shape
    length = 0.0
    for _ in range(20 * (height + width)):
        gap = math.hypot(row - last_row, column - last_column)
        if gap < 1.5:
            return length + gap
        down, right = _slope(found, row, column)
        steep = math.hypot(down, right)
        if steep < 1e-9:
            return np.nan
        row -= STEP * down / steep
        column -= STEP * right / steep
        length += STEP
    return np.nan


@jit
def _slope(found, row, column):
    """Return the direction in which ``found`` grows at a point, between those of the four cells around it."""
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
    """Return how values grow along three cells; one in which nobody can be is higher than any other."""
    if here == np.inf:
        return (1.0 if before < np.inf else 0.0) - (1.0 if after < np.inf else 0.0)
    return (here - before if before < np.inf else 0.0) + (after - here if after < np.inf else 0.0)
