"""Clearance of the robot's body, compiled by numba.

Lengths are in cells, as in ``clearance``. A body is a float64 array (n, 5) of discs (x, y, radius, in the robot's
frame). The first disc contains the whole robot. Unless the robot is a disc, further discs cover its edge, in order. The
last two columns of a disc are the vector from its centre to the point where the edge leaves it. Close to obstacles,
PARTS smaller discs along this vector replace the disc.
"""

import math
from typing import NamedTuple

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import square_distance
from rosoclingo.robot.navigation.compiled.jit import jit
from rosoclingo.robot.navigation.compiled.path import point_clearance

NEAR = 0.75  # cells: maximum error of the interpolation between cells
PARTS = 16


class NearbyObstacles(NamedTuple):
    """Obstacles around a body, without those that it touches already.

    ``clearance``: float32 (H, W), a lower bound at the body. ``occupied``: uint8 (H, W), without the squares that the
    body touches or contains. ``touched``: float64 (n, 3), the column and row of each square that it touches, and its
    distance from the square, which is negative. The body must not move deeper into these squares.
    """

    clearance: np.ndarray
    occupied: np.ndarray
    touched: np.ndarray


@jit
def nearby_obstacles(clearance, occupied, body, x, y, yaw):
    """Return the :class:`NearbyObstacles` of a body at a pose."""
    height, width = occupied.shape
    touched = np.empty((0, 3))
    if point_clearance(clearance, x, y) - body[0, 2] > NEAR:
        return NearbyObstacles(clearance, occupied, touched)
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
    return NearbyObstacles(clearance, others, touched)


@jit
def body_clearance(near, body, x, y, yaw, enough):
    """Return the distance of a body at a pose from the nearest obstacle; negative in collision.

    ``near``: :class:`NearbyObstacles`. For a square that the body touches already, the result is by how much the
    distance has grown. Discs of the edge are skipped if the clearance certainly exceeds ``enough``. The result is exact
    in tight places, elsewhere a lower bound.
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
    """Return the point at a fraction ``part`` (-1 .. 1) of a disc's vector, on the grid."""
    dx, dy = disc[0] + part * disc[3], disc[1] + part * disc[4]
    return x + c * dx - s * dy, y + s * dx + c * dy


@jit
def _disc_gap(occupied, disc, x, y, c, s):
    """Return the distance of a disc, or of its PARTS, from the nearest occupied square, at most NEAR."""
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
    """Return the distance of a body's edge at a pose from the square of a cell; negative inside."""
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
    """Return whether a point is inside the polygon of a body's edge."""
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
