"""The compiled look at the robot's body: how far it is from things, and what it touches already.

Lengths are in cells, as in ``clearance``. A body is a float64 array (n, 5) of discs (x, y,
radius, 0, 0; in the robot's frame): one, or one that the whole robot is in and then the pieces of its edge, each with
the disc around it and its direction (x, y; of length 1).
"""

import math
from typing import NamedTuple

import numpy as np

from rosoclingo.robot.navigation.compiled.jit import jit
from rosoclingo.robot.navigation.compiled.path import point_clearance

__all__ = ["Around", "around", "body_clearance"]

GRAZE = 1e-9  # cells: an edge that goes no deeper does not meet a square


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
            away = _square_clearance(body, x, y, yaw, float(column), float(row))
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
        least = min(least, _gap(_placed(body[i], x, y, c, s), column, row))
    return least


@jit
def _placed(piece, x, y, c, s):
    """Return a piece of a body in cells: x, y, radius and direction (x, y)."""
    px, py = x + c * piece[0] - s * piece[1], y + s * piece[0] + c * piece[1]
    return px, py, piece[2], c * piece[3] - s * piece[4], s * piece[3] + c * piece[4]


@jit
def _gap(piece, column, row):
    """Return how far a disc, or a piece of an edge, is from the square of a cell; less than 0 where they meet.

    A piece in the square is as deep in it as the disc around it.
    """
    x, y, radius, ax, ay = piece
    apart = _point_gap(x, y, column, row)
    if ax == 0.0 and ay == 0.0:
        return apart - radius
    bx, by = radius * ax, radius * ay
    if apart < radius and _meets(x - bx, y - by, 2.0 * bx, 2.0 * by, column, row):
        return apart - radius
    least = min(_point_gap(x - bx, y - by, column, row), _point_gap(x + bx, y + by, column, row))
    for k in range(4):
        dx, dy = column + k % 2 - x, row + k // 2 - y
        along = max(-radius, min(radius, dx * ax + dy * ay))
        least = min(least, math.hypot(dx - along * ax, dy - along * ay))
    return least


@jit
def _point_gap(x, y, column, row):
    """Return the distance of a point from the square of a cell."""
    return math.hypot(max(0.0, max(column - x, x - column - 1.0)), max(0.0, max(row - y, y - row - 1.0)))


@jit
def _meets(x, y, dx, dy, column, row):
    """Tell whether the segment from (x, y) by (dx, dy) has a part within the square of a cell."""
    first, last = 0.0, 1.0
    for at, by, low in ((x, dx, column), (y, dy, row)):
        if abs(by) < GRAZE:
            if not low < at < low + 1.0:
                return False
            continue
        one, other = (low - at) / by, (low + 1.0 - at) / by
        first, last = max(first, min(one, other)), min(last, max(one, other))
    return first < last


@jit
def _is_inside(body, x, y, yaw, px, py):
    """Tell whether a point is within the polygon whose edge a body has the pieces of."""
    c, s = math.cos(yaw), math.sin(yaw)
    dx, dy = px - x, py - y
    px, py = c * dx + s * dy, c * dy - s * dx
    inside, last = False, body.shape[0] - 1
    for i in range(1, body.shape[0]):
        ax, ay = _beginning(body[last])
        bx, by = _beginning(body[i])
        if (ay > py) != (by > py) and px < ax + (py - ay) / (by - ay) * (bx - ax):
            inside = not inside
        last = i
    return inside


@jit
def _beginning(piece):
    """Return the end of a piece that the one before it has too."""
    return piece[0] - piece[2] * piece[3], piece[1] - piece[2] * piece[4]


@jit
def body_clearance(near, body, x, y, yaw, enough):
    """Return how far a body at a pose is from what is nearest; less than 0, the more it is in that.

    ``near``: :class:`Around`; from what is touched there a body is as far as it has come away from it. The pieces of
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
        piece = _placed(body[i], x, y, c, s)
        spare = point_clearance(near.clearance, piece[0], piece[1]) - piece[2]
        if spare - 0.75 < least:  # the interpolation may be that wrong
            if spare < 0.75 and 0.0 <= piece[0] < width and 0.0 <= piece[1] < height:
                spare = _piece_clearance(near.occupied, piece)
            least = min(least, spare)
            within += min(0.0, spare)
    return within if within < 0.0 else least


@jit
def _piece_clearance(occupied, piece):
    """Return how far a piece of a body is from the nearest occupied square, 0.75 if none is nearer."""
    height, width = occupied.shape
    least, reach = 0.75, piece[2] + 0.75
    for row in range(max(0, int(piece[1] - reach)), min(height, int(piece[1] + reach) + 1)):
        for column in range(max(0, int(piece[0] - reach)), min(width, int(piece[0] + reach) + 1)):
            if occupied[row, column]:
                least = min(least, _gap(piece, float(column), float(row)))
    return least
