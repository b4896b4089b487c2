"""Distances of points from a body, compiled by numba.

A body is a disc of some ``radius`` (``outline`` empty) or a polygon: ``outline``, float64 (k, 2), its corners in the
body's frame. All lengths have the same unit.
"""

import math

import numpy as np

from rosoclingo.robot.navigation.compiled.jit import jit


@jit
def segment_distance(px, py, x0, y0, x1, y1):
    """Return the distance of a point from a segment."""
    dx, dy = x1 - x0, y1 - y0
    square = dx * dx + dy * dy
    t = min(1.0, max(0.0, ((px - x0) * dx + (py - y0) * dy) / square)) if square > 0.0 else 0.0
    return math.hypot(px - x0 - t * dx, py - y0 - t * dy)


@jit
def _side(ax, ay, bx, by, px, py):
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@jit
def crosses(ax, ay, bx, by, cx, cy, dx, dy):
    """Return whether two segments cross."""
    across = (_side(ax, ay, bx, by, cx, cy) > 0.0) != (_side(ax, ay, bx, by, dx, dy) > 0.0)
    return across and (_side(cx, cy, dx, dy, ax, ay) > 0.0) != (_side(cx, cy, dx, dy, bx, by) > 0.0)


@jit
def gap(outline, radius, px, py):
    """Return the distance of a point in the body's frame from its edge, negative inside."""
    if outline.shape[0] == 0:
        return math.hypot(px, py) - radius
    least, within = np.inf, False
    j = outline.shape[0] - 1
    for i in range(outline.shape[0]):
        x0, y0, x1, y1 = outline[j, 0], outline[j, 1], outline[i, 0], outline[i, 1]
        least = min(least, segment_distance(px, py, x0, y0, x1, y1))
        if (y1 > py) != (y0 > py) and px < x1 + (x0 - x1) * (py - y1) / (y0 - y1):
            within = not within
        j = i
    return -least if within else least


@jit
def to_body(x, y, yaw, px, py):
    """Convert a point to the frame of a body at the pose (x, y, yaw)."""
    c, s = math.cos(yaw), math.sin(yaw)
    return c * (px - x) + s * (py - y), c * (py - y) - s * (px - x)


@jit
def gaps(outline, radius, x, y, yaw, points):
    """Return the distances (float64 n) of points (float64 n, 2) from the edge of a body at the pose (x, y, yaw)."""
    found = np.empty(points.shape[0])
    for i in range(points.shape[0]):
        bx, by = to_body(x, y, yaw, points[i, 0], points[i, 1])
        found[i] = gap(outline, radius, bx, by)
    return found
