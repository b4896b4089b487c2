"""Compiled geometry of the simulated world: what a body touches, and what a beam meets.

Lengths are in cells of the world's grid, as in ``clearance``. ``segments`` is float64 (n, 4):
x0, y0, x1, y1; ``discs`` float64 (m, 3): x, y, radius. A body is a disc (``outline`` empty) or a polygon: ``outline``,
float64 (k, 2), its corners in the body's frame.
"""

import math

from rosoclingo.robot.navigation.compiled.jit import jit

__all__ = [
    "CLEAR",
    "HIT_DISC",
    "HIT_SEGMENT",
    "HIT_WALL",
    "body_hits",
    "covers_wall",
    "inside",
    "shorten_rays",
    "sweep",
]

CLEAR, HIT_WALL, HIT_SEGMENT, HIT_DISC = 0, 1, 2, 3


@jit
def _point_segment(px, py, x0, y0, x1, y1):
    """Return the distance of a point from a segment."""
    dx, dy = x1 - x0, y1 - y0
    length2 = dx * dx + dy * dy
    t = 0.0
    if length2 > 0.0:
        t = min(1.0, max(0.0, ((px - x0) * dx + (py - y0) * dy) / length2))
    return math.hypot(px - x0 - t * dx, py - y0 - t * dy)


@jit
def _side(ax, ay, bx, by, px, py):
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@jit
def _segments_meet(ax, ay, bx, by, cx, cy, dx, dy):
    """Tell whether two segments have a point in common (collinear ones: by their ends)."""
    d1, d2 = _side(ax, ay, bx, by, cx, cy), _side(ax, ay, bx, by, dx, dy)
    d3, d4 = _side(cx, cy, dx, dy, ax, ay), _side(cx, cy, dx, dy, bx, by)
    if ((d1 > 0.0) != (d2 > 0.0)) and ((d3 > 0.0) != (d4 > 0.0)):
        return True
    return min(_point_segment(ax, ay, cx, cy, dx, dy), _point_segment(cx, cy, ax, ay, bx, by)) < 1e-9


@jit
def _disc_hits(occupied, segments, discs, x, y, radius):
    """Tell what a disc overlaps: CLEAR, HIT_WALL, HIT_SEGMENT or HIT_DISC."""
    height, width = occupied.shape
    for row in range(max(0, int(y - radius)), min(height, int(y + radius) + 1)):
        for column in range(max(0, int(x - radius)), min(width, int(x + radius) + 1)):
            if occupied[row, column]:
                dx = max(0.0, max(column - x, x - column - 1.0))
                dy = max(0.0, max(row - y, y - row - 1.0))
                if dx * dx + dy * dy < radius * radius:
                    return HIT_WALL
    for i in range(segments.shape[0]):
        if _point_segment(x, y, segments[i, 0], segments[i, 1], segments[i, 2], segments[i, 3]) < radius:
            return HIT_SEGMENT
    for i in range(discs.shape[0]):
        if math.hypot(discs[i, 0] - x, discs[i, 1] - y) < discs[i, 2] + radius:
            return HIT_DISC
    return CLEAR


@jit
def _edge_hits_wall(occupied, x0, y0, x1, y1) -> bool:
    """Tell whether a segment passes through an occupied cell."""
    height, width = occupied.shape
    dx, dy = x1 - x0, y1 - y0
    column, row = math.floor(x0), math.floor(y0)
    last_c, last_r = math.floor(x1), math.floor(y1)
    step_c, step_r = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    per_c = abs(1.0 / dx) if dx != 0.0 else math.inf
    per_r = abs(1.0 / dy) if dy != 0.0 else math.inf
    next_c = ((column + 1 - x0) if dx > 0 else (x0 - column)) * per_c if dx != 0.0 else math.inf
    next_r = ((row + 1 - y0) if dy > 0 else (y0 - row)) * per_r if dy != 0.0 else math.inf
    for _ in range(abs(last_c - column) + abs(last_r - row) + 1):
        if 0 <= row < height and 0 <= column < width and occupied[row, column]:
            return True
        if next_c < next_r:
            next_c, column = next_c + per_c, column + step_c
        else:
            next_r, row = next_r + per_r, row + step_r
    return False


@jit
def inside(outline, px, py):
    """Tell whether a point is inside of a polygon, both in the same frame."""
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
def covers_wall(occupied, outline, x, y, yaw):
    """Tell whether an occupied cell's middle lies within a polygon: of one that no edge touches, all of it does."""
    c, s = math.cos(yaw), math.sin(yaw)
    reach = 0.0
    for i in range(outline.shape[0]):
        reach = max(reach, math.hypot(outline[i, 0], outline[i, 1]))
    height, width = occupied.shape
    for row in range(max(0, int(y - reach)), min(height, int(y + reach) + 1)):
        for column in range(max(0, int(x - reach)), min(width, int(x + reach) + 1)):
            dx, dy = column + 0.5 - x, row + 0.5 - y
            if occupied[row, column] and inside(outline, c * dx + s * dy, c * dy - s * dx):
                return True
    return False


@jit
def _polygon_hits(occupied, segments, discs, outline, x, y, yaw):
    """Tell what a polygon overlaps, as :func:`_disc_hits` does."""
    c, s = math.cos(yaw), math.sin(yaw)
    count = outline.shape[0]
    for i in range(count):
        j = (i + 1) % count
        ax, ay = x + c * outline[i, 0] - s * outline[i, 1], y + s * outline[i, 0] + c * outline[i, 1]
        bx, by = x + c * outline[j, 0] - s * outline[j, 1], y + s * outline[j, 0] + c * outline[j, 1]
        if _edge_hits_wall(occupied, ax, ay, bx, by):
            return HIT_WALL
        for k in range(segments.shape[0]):
            if _segments_meet(ax, ay, bx, by, segments[k, 0], segments[k, 1], segments[k, 2], segments[k, 3]):
                return HIT_SEGMENT
        for k in range(discs.shape[0]):
            if _point_segment(discs[k, 0], discs[k, 1], ax, ay, bx, by) < discs[k, 2]:
                return HIT_DISC
    for k in range(segments.shape[0]):
        dx, dy = segments[k, 0] - x, segments[k, 1] - y
        if inside(outline, c * dx + s * dy, c * dy - s * dx):
            return HIT_SEGMENT
    for k in range(discs.shape[0]):
        dx, dy = discs[k, 0] - x, discs[k, 1] - y
        if inside(outline, c * dx + s * dy, c * dy - s * dx):
            return HIT_DISC
    return CLEAR


@jit
def body_hits(occupied, segments, discs, outline, radius, x, y, yaw):
    """Tell what a body at a pose overlaps: CLEAR, HIT_WALL, HIT_SEGMENT or HIT_DISC."""
    if outline.shape[0] == 0:
        return _disc_hits(occupied, segments, discs, x, y, radius)
    return _polygon_hits(occupied, segments, discs, outline, x, y, yaw)


@jit
def sweep(occupied, segments, discs, outline, radius, x, y, yaw, v, w, dt, grain):
    """Return (part, hit): how much of an arc (0 .. 1) a body can go before it overlaps something, and what.

    Looks every ``grain`` cells, which must be less than the body's width and a cell's, or it could leap over a door
    or a wall; v in cells/s. The body stops at the last place where it was clear.
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
def shorten_rays(x, y, angles, segments, discs, out) -> None:
    """Shorten the ranges ``out`` (float64 n) of rays from (x, y) at ``angles`` to the segments and discs they meet."""
    for i in range(angles.shape[0]):
        dx, dy = math.cos(angles[i]), math.sin(angles[i])
        for k in range(segments.shape[0]):
            ex, ey = segments[k, 2] - segments[k, 0], segments[k, 3] - segments[k, 1]
            fx, fy = segments[k, 0] - x, segments[k, 1] - y
            cross = dx * ey - dy * ex
            if cross != 0.0:
                t = (fx * ey - fy * ex) / cross
                u = (fx * dy - fy * dx) / cross
                if 0.0 <= u <= 1.0 and 0.0 <= t < out[i]:
                    out[i] = t
        for k in range(discs.shape[0]):
            fx, fy = discs[k, 0] - x, discs[k, 1] - y
            along = fx * dx + fy * dy
            square = discs[k, 2] * discs[k, 2] - (fx * fx + fy * fy - along * along)
            if square >= 0.0:
                t = along - math.sqrt(square)
                if fx * fx + fy * fy <= discs[k, 2] * discs[k, 2]:
                    t = 0.0
                if 0.0 <= t < out[i]:
                    out[i] = t
