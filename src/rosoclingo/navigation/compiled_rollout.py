"""The compiled trial of commands: which of them stays clear, and which leads best to a point."""

import math

import numpy as np

from rosoclingo.navigation.compiled import jit, square_distance

__all__ = [
    "best_command",
    "body_clearance",
    "furthest_clear",
    "least_along",
    "nearest_index",
    "path_is_clear",
    "point_clearance",
    "points_at",
    "spare_after",
]


@jit
def point_clearance(clearance, x, y):
    """Return the clearance at a point (cells), between the four nearest cell centres; -1 off the grid."""
    height, width = clearance.shape
    fx, fy = x - 0.5, y - 0.5
    column, row = math.floor(fx), math.floor(fy)
    if not (0 <= row < height - 1 and 0 <= column < width - 1):
        return -1.0
    px, py = fx - column, fy - row
    low = clearance[row, column] * (1.0 - px) + clearance[row, column + 1] * px
    high = clearance[row + 1, column] * (1.0 - px) + clearance[row + 1, column + 1] * px
    return low * (1.0 - py) + high * py


@jit
def least_along(clearance, x0, y0, x1, y1):
    """Return the least clearance (cells) along a segment, looked at every third of a cell."""
    count = int(3.0 * math.hypot(x1 - x0, y1 - y0)) + 1
    least = np.inf
    for i in range(count + 1):
        part = i / count
        least = min(least, point_clearance(clearance, x0 + (x1 - x0) * part, y0 + (y1 - y0) * part))
    return least


@jit
def path_is_clear(clearance, points, least) -> bool:
    """Tell whether the way along points (float64 n, 2; cells) keeps ``least`` (cells) of clearance."""
    for i in range(points.shape[0] - 1):
        if least_along(clearance, points[i, 0], points[i, 1], points[i + 1, 0], points[i + 1, 1]) < least:
            return False
    return True


@jit
def nearest_index(points, start, count, x, y):
    """Return the index of that of the ``count`` points (n, 2) from ``start`` on which is nearest to (x, y)."""
    best, best_i = np.inf, start
    for i in range(start, min(start + count, points.shape[0])):
        away = (points[i, 0] - x) ** 2 + (points[i, 1] - y) ** 2
        if away < best:
            best, best_i = away, i
    return best_i


@jit
def points_at(points, along, start, lengths):
    """Return the points (n, 2) at ``lengths``, ascending, behind ``points[start]``; ``along``: where each point is."""
    found = np.empty((lengths.shape[0], 2))
    i, last = start, points.shape[0] - 1
    for k in range(lengths.shape[0]):
        place = min(along[start] + lengths[k], along[last])
        while i < last and along[i + 1] < place:
            i += 1
        step = along[min(i + 1, last)] - along[i]
        part = (place - along[i]) / step if step > 0.0 else 0.0
        for axis in range(2):
            found[k, axis] = points[i, axis] + part * (points[min(i + 1, last), axis] - points[i, axis])
    return found


@jit
def furthest_clear(clearance, x, y, points, least_away, floors):
    """Return the index of the last of ``points`` (cells) that a straight line from (x, y) leads to; -1 for none.

    The line keeps the first of ``floors`` (cells of clearance) that is possible at all; points nearer than
    ``least_away`` are left out.
    """
    spare = np.empty(points.shape[0])
    for i in range(points.shape[0]):
        spare[i] = least_along(clearance, x, y, points[i, 0], points[i, 1])
        if math.hypot(points[i, 0] - x, points[i, 1] - y) < least_away:
            spare[i] = -np.inf
    for floor in floors:
        for i in range(points.shape[0] - 1, -1, -1):
            if spare[i] >= floor:
                return i
    return -1


@jit
def body_clearance(clearance, occupied, body, x, y, yaw):
    """Return how far (cells) a body at a pose is from what is nearest; 0 or less when it touches that.

    ``body``: float64 (n, 3), the discs (x, y, radius in cells, in the robot's frame) that cover the robot. Exact
    where it is tight, interpolated elsewhere.
    """
    least = np.inf
    c, s = math.cos(yaw), math.sin(yaw)
    for i in range(body.shape[0]):
        px = x + c * body[i, 0] - s * body[i, 1]
        py = y + s * body[i, 0] + c * body[i, 1]
        spare = point_clearance(clearance, px, py) - body[i, 2]
        if spare + body[i, 2] > -1.0 and spare < 0.75 and clearance[int(py), int(px)] > -0.9:
            spare = square_distance(occupied, px, py, body[i, 2] + 0.75) - body[i, 2]
        least = min(least, spare)
    return least


@jit
def spare_after(clearance, occupied, body, x, y, yaw, v, w, horizon, steps):
    """Return the least body clearance along an arc of ``horizon`` s, and the pose at its end: (least, x, y, yaw)."""
    dt = horizon / steps
    least = np.inf
    half = 0.5 * w * dt
    chord = v * dt * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)
    for _ in range(steps):
        x += chord * math.cos(yaw + half)
        y += chord * math.sin(yaw + half)
        yaw += w * dt
        least = min(least, body_clearance(clearance, occupied, body, x, y, yaw))
    return least, x, y, yaw


@jit
def best_command(clearance, occupied, body, pose, speeds, turns, carrot, margin, comfort, horizon, steps, weights):
    """Return (index of speed, index of turn, spare) of the best command, indices -1 where none is safe.

    ``pose`` (x, y, yaw; cells, rad), ``speeds`` (cells/s), ``turns`` (rad/s), ``carrot`` (x, y; cells). A command is
    safe when the body keeps ``margin`` for the whole horizon or, if it has not got it now, does not come closer.
    ``weights``: of the distance to the carrot (1/cell), the angle to it (1/rad), nearness to obstacles (1/cell).
    """
    now = body_clearance(clearance, occupied, body, pose[0], pose[1], pose[2])
    floor = min(margin, now - 1e-6)
    best, best_i, best_j, best_spare = np.inf, -1, -1, 0.0
    for i in range(speeds.shape[0]):
        for j in range(turns.shape[0]):
            if abs(speeds[i]) < 1e-6 and abs(turns[j]) < 0.05:
                continue  # to stand still is the caller's last resort
            spare, x, y, yaw = spare_after(
                clearance, occupied, body, pose[0], pose[1], pose[2], speeds[i], turns[j], horizon, steps
            )
            if spare < floor:
                continue
            away = math.hypot(carrot[0] - x, carrot[1] - y)
            bearing = math.atan2(carrot[1] - y, carrot[0] - x) - yaw
            angle = abs(math.atan2(math.sin(bearing), math.cos(bearing)))
            # Next to the carrot its direction says little.
            angle *= min(1.0, 0.5 * away)
            score = weights[0] * away + weights[1] * angle + weights[2] * max(0.0, comfort - spare)
            if score < best:
                best, best_i, best_j, best_spare = score, i, j, spare
    return best_i, best_j, best_spare
