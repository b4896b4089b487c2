"""The compiled look at the robot's body: how far it is from things, and what it touches already.

Lengths are in cells, as in ``clearance``. A body is a float64 array (n, 5) of discs (x, y, radius; in the robot's
frame): one that the whole robot is in and then, unless that is the robot itself, those that cover its edge, in order.
Each of these has the vector (x, y) from its middle to where the edge leaves it: close to things, PARTS smaller discs
along that stand for it.
"""

import math
from typing import NamedTuple

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import square_distance
from rosoclingo.robot.navigation.compiled.jit import jit
from rosoclingo.robot.navigation.compiled.path import point_clearance

NEAR = 0.75  # cells: the interpolation between cells can be that wrong
PARTS = 16


class Around(NamedTuple):
    """What a body is tried against.

    ``clearance``: float32 (H, W), a lower bound where the body is; ``occupied``: uint8 (H, W), without the squares that
    the body touches or has in it. The former are in ``touched``: float64 (n, 3) of column, row and the body's distance
    from the square, which is less than 0. A body must go no deeper into these, and touch nothing else.
    """

    clearance: np.ndarray
    occupied: np.ndarray
    touched: np.ndarray


@jit
def around(clearance, occupied, body, x, y, yaw):
    """Return the :class:`Around` of a body at a pose."""
    height, width = occupied.shape
    touched = np.empty((0, 3))
    if point_clearance(clearance, x, y) - body[0, 2] > NEAR:
        return Around(clearance, occupied, touched)
    others, reach = occupied, body[0, 2] + 1.0
    for row in range(max(0, int(y - reach)), min(height, int(y + reach) + 1)):
        for column in range(max(0, int(x - reach)), min(width, int(x + reach) + 1)):
            if not occupied[row, column]:
                continue
            away = _square_gap(body, x, y, yaw, float(column), float(row))
            if away < 0.0:
                touched = np.append(touched, np.array([[float(column), float(row), away]]), axis=0)
            if away < 0.0 or _is_inside(body, x, y, yaw, column + 0.5, row + 0.5):
                if others is occupied:
                    others = occupied.copy()
                others[row, column] = 0
    return Around(clearance, others, touched)


@jit
def body_clearance(near, body, x, y, yaw, enough):
    """Return how far a body at a pose is from the nearest thing; less than 0 where it is in that.

    ``near``: :class:`Around`; from a square that it touches there a body is as far as it has come away from it. The
    discs of the edge are left out where more than ``enough`` is certain. Exact where it is tight, else a lower bound.
    """
    first = min(1, body.shape[0] - 1)
    if first:
        spare = point_clearance(near.clearance, x, y) - body[0, 2]
        if spare > enough:
            return spare
    least = np.inf
    for i in range(near.touched.shape[0]):
        column, row, before = near.touched[i, 0], near.touched[i, 1], near.touched[i, 2]
        least = min(least, _square_gap(body, x, y, yaw, column, row) - before)
    c, s = math.cos(yaw), math.sin(yaw)
    for i in range(first, body.shape[0]):
        px, py = _placed(body[i], x, y, c, s, 0.0)
        spare = point_clearance(near.clearance, px, py) - body[i, 2]
        if spare - NEAR < least:
            if spare < NEAR:
                spare = _disc_gap(near.occupied, body[i], x, y, c, s)
            least = min(least, spare)
    return least


@jit
def _placed(disc, x, y, c, s, part):
    """Return where a ``part`` (-1 .. 1) of a disc's vector ends."""
    dx, dy = disc[0] + part * disc[3], disc[1] + part * disc[4]
    return x + c * dx - s * dy, y + s * dx + c * dy


@jit
def _disc_gap(occupied, disc, x, y, c, s):
    """Return how far a disc is from the nearest occupied square, or the PARTS for which it stands; NEAR at most."""
    px, py = _placed(disc, x, y, c, s, 0.0)
    gap = square_distance(occupied, px, py, disc[2] + NEAR) - disc[2]
    if gap < disc[2] and (disc[3] != 0.0 or disc[4] != 0.0):
        gap = NEAR
        for k in range(PARTS):
            px, py = _placed(disc, x, y, c, s, (2.0 * k + 1.0) / PARTS - 1.0)
            gap = min(gap, square_distance(occupied, px, py, disc[2] + NEAR) - disc[2] / PARTS)
    return gap


@jit
def _square_gap(body, x, y, yaw, column, row):
    """Return how far the edge of a body at a pose, by its PARTS, is from the square of a cell; less than 0 inside."""
    c, s = math.cos(yaw), math.sin(yaw)
    least = np.inf
    for i in range(min(1, body.shape[0] - 1), body.shape[0]):
        px, py = _placed(body[i], x, y, c, s, 0.0)
        gap = _point_gap(px, py, column, row) - body[i, 2]
        if gap < body[i, 2] and (body[i, 3] != 0.0 or body[i, 4] != 0.0):
            gap = np.inf
            for k in range(PARTS):
                px, py = _placed(body[i], x, y, c, s, (2.0 * k + 1.0) / PARTS - 1.0)
                gap = min(gap, _point_gap(px, py, column, row) - body[i, 2] / PARTS)
        least = min(least, gap)
    return least


@jit
def _point_gap(x, y, column, row):
    """Return the distance of a point from the square of a cell."""
    return math.hypot(max(0.0, max(column - x, x - column - 1.0)), max(0.0, max(row - y, y - row - 1.0)))


@jit
def _is_inside(body, x, y, yaw, px, py):
    """Return whether a point is within the polygon whose edge the discs of a body cover."""
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
