"""Geometry of the simulated world, compiled by numba: collisions of bodies, and beams.

Lengths are in cells of the world's grid, as in ``clearance``. Bodies are those of ``outlines``. Obstacles are
``occupied`` cells (uint8 H, W), ``segments`` (float64 n, 4: x0, y0, x1, y1) and ``discs`` (float64 m, 3: x, y, radius).
"""

import math

from rosoclingo.robot.navigation.compiled.clearance import ray_length, square_distance
from rosoclingo.robot.navigation.compiled.jit import jit
from rosoclingo.robot.navigation.compiled.outlines import gap, segment_distance, to_body

CLEAR, HIT_WALL, HIT_SEGMENT, HIT_DISC = 0, 1, 2, 3


@jit
def _side(ax, ay, bx, by, px, py):
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@jit
def _segments_meet(ax, ay, bx, by, cx, cy, dx, dy):
    """Return whether two segments have a common point."""
    across = (_side(ax, ay, bx, by, cx, cy) > 0.0) != (_side(ax, ay, bx, by, dx, dy) > 0.0)
    if across and (_side(cx, cy, dx, dy, ax, ay) > 0.0) != (_side(cx, cy, dx, dy, bx, by) > 0.0):
        return True
    return min(segment_distance(ax, ay, cx, cy, dx, dy), segment_distance(cx, cy, ax, ay, bx, by)) < 1e-9


@jit
def _overlaps_segment(outline, radius, x0, y0, x1, y1):
    """Return whether a body overlaps a segment in its frame."""
    if outline.shape[0] == 0:
        return segment_distance(0.0, 0.0, x0, y0, x1, y1) < radius
    for i in range(outline.shape[0]):
        a, b = outline[i - 1], outline[i]
        if _segments_meet(a[0], a[1], b[0], b[1], x0, y0, x1, y1):
            return True
    return gap(outline, radius, x0, y0) < 0.0


@jit
def _overlaps_wall(occupied, outline, radius, x, y, yaw):
    """Return whether a body at a pose overlaps an occupied cell: by an edge, or by containing its centre."""
    if outline.shape[0] == 0:
        return square_distance(occupied, x, y, radius) < radius
    c, s = math.cos(yaw), math.sin(yaw)
    reach = 0.0
    for i in range(outline.shape[0]):
        a, b = outline[i - 1], outline[i]
        ax, ay, dx, dy = x + c * a[0] - s * a[1], y + s * a[0] + c * a[1], b[0] - a[0], b[1] - a[1]
        length = max(math.hypot(dx, dy), 1e-12)
        if ray_length(occupied, ax, ay, (c * dx - s * dy) / length, (s * dx + c * dy) / length, length) < length:
            return True
        reach = max(reach, math.hypot(b[0], b[1]))
    height, width = occupied.shape
    for row in range(max(0, int(y - reach)), min(height, int(y + reach) + 1)):
        for column in range(max(0, int(x - reach)), min(width, int(x + reach) + 1)):
            if occupied[row, column]:
                px, py = to_body(x, y, yaw, column + 0.5, row + 0.5)
                if gap(outline, radius, px, py) < 0.0:
                    return True
    return False


@jit
def body_hits(occupied, segments, discs, outline, radius, x, y, yaw):
    """Return which kind of obstacle a body at a pose overlaps: CLEAR, HIT_WALL, HIT_SEGMENT or HIT_DISC."""
    if _overlaps_wall(occupied, outline, radius, x, y, yaw):
        return HIT_WALL
    for k in range(segments.shape[0]):
        x0, y0 = to_body(x, y, yaw, segments[k, 0], segments[k, 1])
        x1, y1 = to_body(x, y, yaw, segments[k, 2], segments[k, 3])
        if _overlaps_segment(outline, radius, x0, y0, x1, y1):
            return HIT_SEGMENT
    for k in range(discs.shape[0]):
        px, py = to_body(x, y, yaw, discs[k, 0], discs[k, 1])
        if gap(outline, radius, px, py) < discs[k, 2]:
            return HIT_DISC
    return CLEAR


@jit
def sweep(occupied, segments, discs, outline, radius, x, y, yaw, v, w, dt, grain):
    """Return (part, hit): the fraction (0 .. 1) of an arc before the first collision, and its kind.

    ``v`` is in cells/s. The arc is tested every ``grain`` cells. This must be less than the body's width and less than
    a cell, otherwise the body could jump over a door or a wall. The body stops at the last collision-free pose.
    """
    if outline.shape[0] == 0 and v == 0.0:
        return 1.0, CLEAR
    count = max(1, math.ceil((abs(v) + abs(w) * (radius if outline.shape[0] else 0.0)) * dt / grain))
    for k in range(1, count + 1):
        half = 0.5 * w * dt * k / count
        chord = v * dt * k / count * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
        px, py = x + chord * math.cos(yaw + half), y + chord * math.sin(yaw + half)
        hit = body_hits(occupied, segments, discs, outline, radius, px, py, yaw + 2.0 * half)
        if hit != CLEAR:
            return (k - 1) / count, hit
    return 1.0, CLEAR


@jit
def cast_rays(occupied, segments, discs, x, y, angles, reach, out) -> None:
    """Write the lengths of rays from (x, y) at ``angles`` (rad) into ``out`` (float64 n).

    A ray ends at the first obstacle, at most at ``reach``. A ray that starts inside an obstacle has length 0.
    """
    for i in range(angles.shape[0]):
        dx, dy = math.cos(angles[i]), math.sin(angles[i])
        best = ray_length(occupied, x, y, dx, dy, reach)
        for k in range(segments.shape[0]):
            fx, fy = segments[k, 0] - x, segments[k, 1] - y
            ex, ey = segments[k, 2] - segments[k, 0], segments[k, 3] - segments[k, 1]
            cross = dx * ey - dy * ex
            if cross != 0.0 and 0.0 <= (fx * dy - fy * dx) / cross <= 1.0 and 0.0 <= (fx * ey - fy * ex) / cross:
                best = min(best, (fx * ey - fy * ex) / cross)
        for k in range(discs.shape[0]):
            fx, fy, size = discs[k, 0] - x, discs[k, 1] - y, discs[k, 2]
            along = fx * dx + fy * dy
            square = size * size - (fx * fx + fy * fy - along * along)
            if fx * fx + fy * fy <= size * size:
                best = 0.0
            elif square >= 0.0 and along >= math.sqrt(square):
                best = min(best, along - math.sqrt(square))
        out[i] = best
