"""Geometry of the simulated world, compiled by numba: collisions of bodies, and beams.

Lengths are in cells of the world's grid, as in ``clearance``. A body is a disc (``outline`` empty) or a polygon:
``outline``, float64 (k, 2), its corners in the body's frame.
"""

import math
from typing import NamedTuple

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import ray_length, square_distance
from rosoclingo.robot.navigation.compiled.jit import jit

CLEAR, HIT_WALL, HIT_SEGMENT, HIT_DISC = 0, 1, 2, 3


class Surroundings(NamedTuple):
    """Obstacles of a robot. Python passes the fields separately, since numba unpacks tuples slowly.

    ``occupied``: uint8 (H, W); ``segments``: float64 (n, 4): x0, y0, x1, y1; ``discs``: float64 (m, 3): x, y, radius.
    """

    occupied: np.ndarray
    segments: np.ndarray
    discs: np.ndarray


@jit
def _four(row):
    return row[0], row[1], row[2], row[3]


@jit
def _three(row):
    return row[0], row[1], row[2]


@jit
def _point_segment(px, py, x0, y0, x1, y1):
    """Return the distance of a point from a segment."""
    dx, dy = x1 - x0, y1 - y0
    square = dx * dx + dy * dy
    t = min(1.0, max(0.0, ((px - x0) * dx + (py - y0) * dy) / square)) if square > 0.0 else 0.0
    return math.hypot(px - x0 - t * dx, py - y0 - t * dy)


@jit
def _side(ax, ay, bx, by, px, py):
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@jit
def _segments_meet(ax, ay, bx, by, cx, cy, dx, dy):
    """Return whether two segments have a common point."""
    across = (_side(ax, ay, bx, by, cx, cy) > 0.0) != (_side(ax, ay, bx, by, dx, dy) > 0.0)
    if across and (_side(cx, cy, dx, dy, ax, ay) > 0.0) != (_side(cx, cy, dx, dy, bx, by) > 0.0):
        return True
    return min(_point_segment(ax, ay, cx, cy, dx, dy), _point_segment(cx, cy, ax, ay, bx, by)) < 1e-9


@jit
def inside(outline, px, py):
    """Return whether a point is inside a polygon; both are in the same frame."""
    within = False
    j = outline.shape[0] - 1
    for i in range(outline.shape[0]):
        if (outline[i, 1] > py) != (outline[j, 1] > py):
            cut = (outline[j, 0] - outline[i, 0]) * (py - outline[i, 1]) / (outline[j, 1] - outline[i, 1])
            if px < cut + outline[i, 0]:
                within = not within
        j = i
    return within


@jit
def _disc_hits(surroundings, x, y, radius):
    """Return which kind of obstacle a disc overlaps: CLEAR, HIT_WALL, HIT_SEGMENT or HIT_DISC."""
    if square_distance(surroundings.occupied, x, y, radius) < radius:
        return HIT_WALL
    for k in range(surroundings.segments.shape[0]):
        x0, y0, x1, y1 = _four(surroundings.segments[k])
        if _point_segment(x, y, x0, y0, x1, y1) < radius:
            return HIT_SEGMENT
    for k in range(surroundings.discs.shape[0]):
        px, py, size = _three(surroundings.discs[k])
        if math.hypot(px - x, py - y) < size + radius:
            return HIT_DISC
    return CLEAR


@jit
def _edge_hits(surroundings, ax, ay, bx, by):
    """Return which kind of obstacle an edge of a polygon overlaps; see :func:`_disc_hits`."""
    length = math.hypot(bx - ax, by - ay)
    dx, dy = (bx - ax) / max(length, 1e-12), (by - ay) / max(length, 1e-12)
    if ray_length(surroundings.occupied, ax, ay, dx, dy, length) < length:
        return HIT_WALL
    for k in range(surroundings.segments.shape[0]):
        x0, y0, x1, y1 = _four(surroundings.segments[k])
        if _segments_meet(ax, ay, bx, by, x0, y0, x1, y1):
            return HIT_SEGMENT
    for k in range(surroundings.discs.shape[0]):
        px, py, size = _three(surroundings.discs[k])
        if _point_segment(px, py, ax, ay, bx, by) < size:
            return HIT_DISC
    return CLEAR


@jit
def _holds(surroundings, outline, x, y, yaw):
    """Return which kind of obstacle lies inside a polygon; see :func:`_disc_hits`.

    Tests one point of each segment and disc.
    """
    c, s = math.cos(yaw), math.sin(yaw)
    for k in range(surroundings.segments.shape[0]):
        x0, y0, _x1, _y1 = _four(surroundings.segments[k])
        if inside(outline, c * (x0 - x) + s * (y0 - y), c * (y0 - y) - s * (x0 - x)):
            return HIT_SEGMENT
    for k in range(surroundings.discs.shape[0]):
        px, py, _size = _three(surroundings.discs[k])
        if inside(outline, c * (px - x) + s * (py - y), c * (py - y) - s * (px - x)):
            return HIT_DISC
    return CLEAR


@jit
def _holds_wall(occupied, outline, x, y, yaw):
    """Return whether the centre of an occupied cell lies inside a polygon."""
    c, s = math.cos(yaw), math.sin(yaw)
    reach = np.sqrt((outline**2).sum(axis=1).max())
    height, width = occupied.shape
    for row in range(max(0, int(y - reach)), min(height, int(y + reach) + 1)):
        for column in range(max(0, int(x - reach)), min(width, int(x + reach) + 1)):
            dx, dy = column + 0.5 - x, row + 0.5 - y
            if occupied[row, column] and inside(outline, c * dx + s * dy, c * dy - s * dx):
                return True
    return False


@jit
def body_hits(occupied, segments, discs, outline, radius, x, y, yaw):
    """Return which kind of obstacle a body at a pose overlaps: CLEAR, HIT_WALL, HIT_SEGMENT or HIT_DISC."""
    hit = _body_hits(Surroundings(occupied, segments, discs), outline, radius, x, y, yaw)
    if hit == CLEAR and outline.shape[0] > 0 and _holds_wall(occupied, outline, x, y, yaw):
        return HIT_WALL  # occupied cells that no edge touches
    return hit


@jit
def _body_hits(surroundings, outline, radius, x, y, yaw):
    count = outline.shape[0]
    if count == 0:
        return _disc_hits(surroundings, x, y, radius)
    c, s = math.cos(yaw), math.sin(yaw)
    for i in range(count):
        a, b = outline[i], outline[(i + 1) % count]
        ax, ay, bx, by = (
            x + c * a[0] - s * a[1],
            y + s * a[0] + c * a[1],
            x + c * b[0] - s * b[1],
            y + s * b[0] + c * b[1],
        )
        hit = _edge_hits(surroundings, ax, ay, bx, by)
        if hit != CLEAR:
            return hit
    return _holds(surroundings, outline, x, y, yaw)


@jit
def sweep(occupied, segments, discs, outline, radius, x, y, yaw, v, w, dt, grain):
    """Return (part, hit): the fraction (0 .. 1) of an arc before the first collision, and its kind.

    ``v`` is in cells/s. The arc is tested every ``grain`` cells. This must be less than the body's width and less than
    a cell, otherwise the body could jump over a door or a wall. The body stops at the last collision-free pose.
    """
    if outline.shape[0] == 0 and v == 0.0:
        return 1.0, CLEAR
    surroundings = Surroundings(occupied, segments, discs)
    count = max(1, math.ceil((abs(v) + abs(w) * (radius if outline.shape[0] else 0.0)) * dt / grain))
    for k in range(1, count + 1):
        half = 0.5 * w * dt * k / count
        chord = v * dt * k / count * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
        px, py = x + chord * math.cos(yaw + half), y + chord * math.sin(yaw + half)
        hit = _body_hits(surroundings, outline, radius, px, py, yaw + 2.0 * half)
        if hit != CLEAR:
            return (k - 1) / count, hit
    return 1.0, CLEAR


@jit
def cast_rays(occupied, segments, discs, x, y, angles, reach, out) -> None:
    """Write the lengths of rays from (x, y) at ``angles`` (rad) into ``out`` (float64 n).

    A ray ends at the first obstacle, at most at ``reach``. A ray that starts inside an obstacle has length 0.
    """
    surroundings = Surroundings(occupied, segments, discs)
    for i in range(angles.shape[0]):
        dx, dy = math.cos(angles[i]), math.sin(angles[i])
        best = ray_length(surroundings.occupied, x, y, dx, dy, reach)
        for k in range(surroundings.segments.shape[0]):
            x0, y0, x1, y1 = _four(surroundings.segments[k])
            ex, ey, fx, fy = x1 - x0, y1 - y0, x0 - x, y0 - y
            cross = dx * ey - dy * ex
            if cross != 0.0 and 0.0 <= (fx * dy - fy * dx) / cross <= 1.0 and 0.0 <= (fx * ey - fy * ex) / cross:
                best = min(best, (fx * ey - fy * ex) / cross)
        for k in range(surroundings.discs.shape[0]):
            px, py, size = _three(surroundings.discs[k])
            fx, fy = px - x, py - y
            along = fx * dx + fy * dy
            square = size * size - (fx * fx + fy * fy - along * along)
            if fx * fx + fy * fy <= size * size:
                best = 0.0
            elif square >= 0.0 and along >= math.sqrt(square):
                best = min(best, along - math.sqrt(square))
        out[i] = best
