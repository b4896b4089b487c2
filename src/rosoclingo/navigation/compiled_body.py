"""The compiled look at the robot's body: how far it is from things, and what it touches already.

Lengths are in cells, as in :mod:`rosoclingo.navigation.compiled`. A body is a float64 array (n, 3) of discs (x, y,
radius; in the robot's frame): one, or one that the whole robot is in and those along its edge.
"""

import math
from typing import NamedTuple

import numpy as np

from rosoclingo.navigation.compiled import square_distance
from rosoclingo.navigation.compiled_path import point_clearance
from rosoclingo.navigation.jit import jit

__all__ = ["Around", "around", "body_clearance"]


class Around(NamedTuple):
    """What a body is tried against.

    ``clearance``: float32 (H, W), a lower bound where the body is; ``occupied``: uint8 (H, W), without the squares that
    the body touches or has in it; those it touches are in ``touched``: float64 (n, 3) of column, row and the body's
    distance from it, which is less than 0. A body may go no deeper into what it touches, and touch nothing else.
    """

    clearance: np.ndarray
    occupied: np.ndarray
    touched: np.ndarray


@jit
def around(clearance, occupied, body, x, y, yaw):
    """Return the :class:`Around` of a body at a pose."""
    height, width = occupied.shape
    touched = np.empty((0, 3))
    if point_clearance(clearance, x, y) - body[0, 2] > 0.75:
        return Around(clearance, occupied, touched)
    others, reach = occupied, body[0, 2] + 1.0
    for row in range(max(0, int(y - reach)), min(height, int(y + reach) + 1)):
        for column in range(max(0, int(x - reach)), min(width, int(x + reach) + 1)):
            if not occupied[row, column]:
                continue
            away = _square_clearance(body, x, y, yaw, column, row)
            if away < 0.0:
                touched = np.append(touched, np.array([[float(column), float(row), away]]), axis=0)
            if away < 0.0 or _is_inside(body, x, y, yaw, column + 0.5, row + 0.5):
                if others is occupied:
                    others = occupied.copy()
                others[row, column] = 0
    return Around(clearance, others, touched)


@jit
def _square_clearance(body, x, y, yaw, column, row):
    """Return how far a body at a pose is from the square of a cell, less than 0 inside; for its edge only."""
    c, s = math.cos(yaw), math.sin(yaw)
    least = np.inf
    for i in range(min(1, body.shape[0] - 1), body.shape[0]):
        px, py = x + c * body[i, 0] - s * body[i, 1], y + s * body[i, 0] + c * body[i, 1]
        dx, dy = max(0.0, max(column - px, px - column - 1.0)), max(0.0, max(row - py, py - row - 1.0))
        least = min(least, math.hypot(dx, dy) - body[i, 2])
    return least


@jit
def _is_inside(body, x, y, yaw, px, py):
    """Tell whether a point is within the polygon along whose edge a body has discs."""
    c, s = math.cos(yaw), math.sin(yaw)
    dx, dy = px - x, py - y
    px, py = c * dx + s * dy, c * dy - s * dx
    inside, last = False, body.shape[0] - 1
    for i in range(1, body.shape[0]):
        ax, ay, bx, by = body[last, 0], body[last, 1], body[i, 0], body[i, 1]
        if (ay > py) != (by > py) and px < ax + (py - ay) / (by - ay) * (bx - ax):
            inside = not inside
        last = i
    return inside


@jit
def body_clearance(near, body, x, y, yaw, enough):
    """Return how far a body at a pose is from what is nearest; less than 0, the more it is in that.

    ``near``: :class:`Around`; from what is touched there a body is as far as it has come away from it. The discs along
    the edge are left out where more than ``enough`` is certain. Exact where it is tight, interpolated elsewhere.
    """
    height, width = near.clearance.shape
    count = body.shape[0]
    if count > 1:
        spare = point_clearance(near.clearance, x, y) - body[0, 2]
        if spare > enough:
            return spare
    least = np.inf
    for i in range(near.touched.shape[0]):
        away = _square_clearance(body, x, y, yaw, near.touched[i, 0], near.touched[i, 1])
        least = min(least, away - near.touched[i, 2])
    within = min(0.0, least)
    c, s = math.cos(yaw), math.sin(yaw)
    for i in range(min(1, count - 1), count):
        px = x + c * body[i, 0] - s * body[i, 1]
        py = y + s * body[i, 0] + c * body[i, 1]
        spare = point_clearance(near.clearance, px, py) - body[i, 2]
        if spare - 0.75 < least:  # the interpolation may be that wrong
            if spare < 0.75 and 0.0 <= px < width and 0.0 <= py < height:
                spare = square_distance(near.occupied, px, py, body[i, 2] + 0.75) - body[i, 2]
            least = min(least, spare)
            within += min(0.0, spare)
    return within if within < 0.0 else least
