"""Clearance of the robot's body, compiled by numba.

Lengths are in cells, as in ``clearance``. A body is a float64 array (n, 5) of discs (x, y, radius, in the robot's
frame). The first disc contains the whole robot. Unless the robot is a disc, further discs cover its edge. The last two
columns of a disc are the vector from its centre to the point where the edge leaves it. Close to obstacles, PARTS
smaller discs along this vector replace the disc.
"""

import math

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import square_distance
from rosoclingo.robot.navigation.compiled.jit import jit
from rosoclingo.robot.navigation.compiled.path import point_clearance

NEAR = 0.75  # cells: maximum error of the interpolation between cells
PARTS = 16


@jit
def body_clearance(clearance, occupied, body, x, y, yaw, enough):
    """Return the distance of a body at a pose from the nearest obstacle; negative in collision.

    Each disc of the edge with its centre in an occupied cell adds a cell to the depth, so that a body that touches an
    obstacle cannot touch more of it. Discs of the edge are skipped if the clearance certainly exceeds ``enough``. The
    result is exact in tight places, elsewhere a lower bound. ``clearance``: float32 (H, W); ``occupied``: uint8 (H, W).
    """
    first = min(1, body.shape[0] - 1)
    if first:
        spare = point_clearance(clearance, x, y) - body[0, 2]
        if spare > enough:
            return spare
    c, s = math.cos(yaw), math.sin(yaw)
    least, inside = np.inf, 0
    for i in range(first, body.shape[0]):
        px, py = _placed(body[i], x, y, c, s, 0.0)
        spare = point_clearance(clearance, px, py) - body[i, 2]
        if spare - NEAR < max(0.0, least):
            if spare < NEAR:
                spare = _disc_gap(occupied, body[i], x, y, c, s)
                inside += square_distance(occupied, px, py, 1.0) == 0.0
            least = min(least, spare)
    return least - inside


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
