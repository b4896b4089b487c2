"""Clearance of the robot's body, compiled by numba.

Lengths are in cells, as in ``clearance``. A body is a tuple (outline, radius, outer): the first two as in ``outlines``,
and the radius of the circumscribed circle around the robot's origin.
"""

import math

from rosoclingo.robot.navigation.compiled.clearance import HALF_DIAGONAL
from rosoclingo.robot.navigation.compiled.jit import jit
from rosoclingo.robot.navigation.compiled.outlines import crosses, gap, to_body
from rosoclingo.robot.navigation.compiled.path import point_clearance

NEAR = 1.0  # cells: distance up to which the distance of a square is exact
THIN = 0.01  # cells: depth of a body that crosses a square without containing its centre


@jit
def body_clearance(clearance, occupied, body, x, y, yaw, enough):
    """Return the distance of a body at a pose from the nearest obstacle; negative in collision.

    In collision it is less by the number of cells that the body overlaps, so that a body that touches an obstacle
    cannot touch more of it. The result is exact up to NEAR and ``enough``, beyond a lower bound. ``clearance``: float32
    (H, W); ``occupied``: uint8 (H, W).
    """
    outline, radius, outer = body
    spare = point_clearance(clearance, x, y) - outer
    if spare > enough:
        return spare
    least, overlaps = wall_gap(occupied, outline, radius, outer, enough, x, y, yaw)
    return least - overlaps


@jit
def wall_gap(occupied, outline, radius, outer, enough, x, y, yaw):
    """Return the distance of a body at a pose from the nearest occupied square, at most ``enough``.

    The second result is the number of squares that it overlaps.
    """
    height, width = occupied.shape
    least, overlaps, reach = enough, 0, outer + enough
    for row in range(max(0, int(y - reach)), min(height, int(y + reach) + 1)):
        for column in range(max(0, int(x - reach)), min(width, int(x + reach) + 1)):
            left, bottom = float(column), float(row)  # numba compiles a function for each type of its arguments
            if occupied[row, column] and _square_distance(x, y, left, bottom) <= outer + max(least, 0.0):
                away = _square_gap(outline, radius, x, y, yaw, left, bottom)
                least = min(least, away)
                overlaps += away < 0.0
    return least, overlaps


@jit
def _square_gap(outline, radius, x, y, yaw, column, row):
    """Return the distance of a body from the square of the cell at ``column`` and ``row``, negative if they overlap."""
    if outline.shape[0] == 0:
        return _square_distance(x, y, column, row) - radius
    px, py = to_body(x, y, yaw, column + 0.5, row + 0.5)
    least = gap(outline, radius, px, py)
    if least < 0.0:
        return least
    if least > NEAR + HALF_DIAGONAL:
        return least - HALF_DIAGONAL
    for k in range(4):
        px, py = to_body(x, y, yaw, column + k % 2, row + k // 2)
        least = min(least, gap(outline, radius, px, py))
    c, s = math.cos(yaw), math.sin(yaw)
    ax, ay = x + c * outline[-1, 0] - s * outline[-1, 1], y + s * outline[-1, 0] + c * outline[-1, 1]
    for i in range(outline.shape[0]):
        bx, by = x + c * outline[i, 0] - s * outline[i, 1], y + s * outline[i, 0] + c * outline[i, 1]
        least = min(least, _square_distance(bx, by, column, row))
        # A side that crosses the square crosses one of its diagonals.
        up = crosses(ax, ay, bx, by, column, row, column + 1.0, row + 1.0)
        if up or crosses(ax, ay, bx, by, column, row + 1.0, column + 1.0, row):
            least = min(least, -THIN)
        ax, ay = bx, by
    return least


@jit
def _square_distance(x, y, column, row):
    """Return the distance of a point from the square of a cell, negative inside."""
    dx, dy = abs(x - column - 0.5) - 0.5, abs(y - row - 0.5) - 0.5
    return math.hypot(max(dx, 0.0), max(dy, 0.0)) + min(0.0, max(dx, dy))
