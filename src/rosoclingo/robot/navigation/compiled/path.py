"""Position of the robot on a path, and clearance of the path, compiled by numba."""

import math

import numpy as np

from rosoclingo.robot.navigation.compiled.jit import jit


@jit
def point_clearance(clearance, x, y):
    """Return the clearance at a point, interpolated between the four nearest cell centres; -1 off the grid."""
    height, width = clearance.shape
    fx, fy = x - 0.5, y - 0.5
    column, row = math.floor(fx), math.floor(fy)
    if not (0 <= row < height - 1 and 0 <= column < width - 1):
        return -1.0
    px, py = fx - column, fy - row
    low = clearance[row, column] * (1.0 - px) + clearance[row, column + 1] * px
    high = clearance[row + 1, column] * (1.0 - px) + clearance[row + 1, column + 1] * px
    return low * (1.0 - py) + high * py


@jit
def least_along(clearance, x0, y0, x1, y1):
    """Return the minimum clearance along a segment, sampled every third of a cell."""
    count = int(3.0 * math.hypot(x1 - x0, y1 - y0)) + 1
    least = np.inf
    for i in range(count + 1):
        part = i / count
        least = min(least, point_clearance(clearance, x0 + (x1 - x0) * part, y0 + (y1 - y0) * part))
    return least


@jit
def is_blocked(clearance, closed, points, x, y, radius):
    """Return whether a path (float64 n, 2; x, y) has less clearance than ``radius`` somewhere.

    Cells that are ``closed`` (bool H, W) block as well. The part behind the robot at (x, y) is ignored. Near the robot,
    its present clearance is enough.
    """
    best, start = np.inf, 0
    for i in range(points.shape[0]):
        away = (points[i, 0] - x) ** 2 + (points[i, 1] - y) ** 2
        if away < best:
            best, start = away, i
    here = min(radius, point_clearance(clearance, x, y) - 0.1)
    for i in range(start, points.shape[0] - 1):
        x0, y0, x1, y1 = points[i, 0], points[i, 1], points[i + 1, 0], points[i + 1, 1]
        least = here if math.hypot(x0 - x, y0 - y) < 2.0 * radius + 3.0 else radius
        count = int(3.0 * math.hypot(x1 - x0, y1 - y0)) + 1
        for k in range(count + 1):
            px, py = x0 + (x1 - x0) * k / count, y0 + (y1 - y0) * k / count
            if point_clearance(clearance, px, py) < least or closed[int(py), int(px)]:
                return True
    return False


@jit
def place_on(points, along, start, reach, x, y):
    """Return (index, place, distance) of the point on a path nearest to (x, y).

    ``index`` is its segment, ``place`` its distance along the path. The search covers the distance ``reach`` from
    ``points[start]`` (float64 n, 2; at the distance ``along[start]``).
    """
    best, best_i, best_place = (points[start, 0] - x) ** 2 + (points[start, 1] - y) ** 2, start, along[start]
    for i in range(start, points.shape[0] - 1):
        if along[i] > along[start] + reach:
            break
        dx, dy = points[i + 1, 0] - points[i, 0], points[i + 1, 1] - points[i, 1]
        square = dx * dx + dy * dy
        t = 0.0
        if square > 0.0:
            t = min(1.0, max(0.0, ((x - points[i, 0]) * dx + (y - points[i, 1]) * dy) / square))
        away = (points[i, 0] + t * dx - x) ** 2 + (points[i, 1] + t * dy - y) ** 2
        if away < best:
            best, best_i, best_place = away, i, along[i] + t * math.sqrt(square)
    return best_i, best_place, math.sqrt(best)
