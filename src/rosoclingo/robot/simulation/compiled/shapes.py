"""Geometry of the simulated world, compiled by numba: collisions of bodies, and beams.

Lengths are in cells of the world's grid, as in ``clearance``. Bodies are those of ``outlines``. Obstacles are
``occupied`` cells (uint8 H, W), ``segments`` (float64 n, 4: x0, y0, x1, y1) and ``discs`` (float64 m, 3: x, y, radius).
"""

import math

from rosoclingo.robot.navigation.compiled.clearance import ray_length
from rosoclingo.robot.navigation.compiled.footprints import wall_gap
from rosoclingo.robot.navigation.compiled.jit import jit
from rosoclingo.robot.navigation.compiled.outlines import crosses, gap, segment_distance, to_body

CLEAR, HIT_WALL, HIT_SEGMENT, HIT_DISC = 0, 1, 2, 3


@jit
def _segments_meet(ax, ay, bx, by, cx, cy, dx, dy):
    """Return whether two segments have a common point."""
    if crosses(ax, ay, bx, by, cx, cy, dx, dy):
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
def body_hits(occupied, segments, discs, outline, radius, x, y, yaw):
    """Return which kind of obstacle a body at a pose overlaps: CLEAR, HIT_WALL, HIT_SEGMENT or HIT_DISC.

    ``radius`` is that of its circumscribed circle, here and below.
    """
    if wall_gap(occupied, outline, radius, radius, 0.0, x, y, yaw)[1]:
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
