"""The compiled straightening of what the grid planner's search finds.

Lengths are in cells, as in :mod:`rosoclingo.robot.navigation.compiled.clearance`.
"""

import math

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import square_distance
from rosoclingo.robot.navigation.compiled.jit import jit
from rosoclingo.robot.navigation.compiled.places import line_is_clear
from rosoclingo.robot.navigation.compiled.search import cell_cost

__all__ = ["ease", "pull", "straighten", "tighten"]

NUDGE = 1e-3  # cells
FINE = 0.05  # cells: a point is not moved by less


@jit
def _segment_cell_cost(clearance, x0, y0, x1, y1, comfort, weight):
    """Return what a straight segment costs, sampled twice a cell."""
    length = math.hypot(x1 - x0, y1 - y0)
    count = int(2.0 * length) + 1
    total = 0.0
    for i in range(count):
        part = (i + 0.5) / count
        total += cell_cost(clearance[int(y0 + (y1 - y0) * part), int(x0 + (x1 - x0) * part)], comfort, weight)
    return total * length / count


@jit
def straighten(points, ground, comfort, weight):
    """Return the points (float64 n, 2; x, y) that are left when straight lines replace what they can.

    A line replaces a part of the way when it keeps the ground's radius free and costs no more.
    """
    clearance = ground.clearance
    count = points.shape[0]
    cost = np.zeros(count)
    for i in range(1, count):
        cost[i] = cost[i - 1] + _segment_cell_cost(
            clearance, points[i - 1, 0], points[i - 1, 1], points[i, 0], points[i, 1], comfort, weight
        )
    kept = np.empty((count, 2))
    kept[0] = points[0]
    size, here = 1, 0
    while here < count - 1:
        there, stride = here + 1, 1
        while stride > 0:
            probe = min(count - 1, there + stride)
            if probe > there and _shortcut(
                ground, points[here], points[probe], comfort, weight, cost[probe] - cost[here]
            ):
                there, stride = probe, stride * 2
            else:
                stride //= 2
        kept[size] = points[there]
        size, here = size + 1, there
    return kept[:size].copy()


@jit
def pull(points, ground, comfort, weight, rounds):
    """Pull a way of many points (float64 n, 2) straight, part by part: long parts, then ever shorter ones, everywhere.

    Points are moved onto the line between the ends of their part when that is clear and costs no more.
    """
    count = points.shape[0]
    cost = np.empty(count - 1)  # of the segment behind each point
    for i in range(count - 1):
        cost[i] = _cost_between(ground.clearance, points[i], points[i + 1], comfort, weight)
    for _ in range(rounds):
        span = count - 1
        while span >= 4:
            for i in range(0, count - span, max(1, span // 4)):
                j = i + span
                if _shortcut(ground, points[i], points[j], comfort, weight, cost[i:j].sum()):
                    for k in range(1, span):
                        points[i + k] = points[i] + (points[j] - points[i]) * (k / span)
                    for k in range(i, j):
                        cost[k] = _cost_between(ground.clearance, points[k], points[k + 1], comfort, weight)
            span = span * 2 // 3


@jit
def _cost_between(clearance, a, b, comfort, weight):
    """Return what a straight segment between two points costs."""
    return _segment_cell_cost(clearance, a[0], a[1], b[0], b[1], comfort, weight)


@jit
def _shortcut(ground, start, end, comfort, weight, cost):
    """Tell whether the line between two points is clear and costs no more than ``cost``."""
    x0, y0, x1, y1 = start[0], start[1], end[0], end[1]
    if not line_is_clear(ground, x0, y0, x1, y1, ground.radius):
        return False
    return _segment_cell_cost(ground.clearance, x0, y0, x1, y1, comfort, weight) <= cost * 1.0005 + 1e-6


@jit
def tighten(points, ground, comfort, weight, rounds):
    """Pull a way (float64 n, 2) tight: move inner points towards the line between their neighbours where that pays."""
    clearance = ground.clearance
    for _ in range(rounds):
        for i in range(1, points.shape[0] - 1):
            a, b = points[i - 1], points[i + 1]
            x, y = points[i, 0], points[i, 1]
            dx, dy = b[0] - a[0], b[1] - a[1]
            square = dx * dx + dy * dy
            t = 0.5
            if square > 0.0:
                t = min(1.0, max(0.0, ((x - a[0]) * dx + (y - a[1]) * dy) / square))
            aim_x, aim_y = a[0] + t * dx, a[1] + t * dy
            now = _segment_cell_cost(clearance, a[0], a[1], x, y, comfort, weight)
            now += _segment_cell_cost(clearance, x, y, b[0], b[1], comfort, weight)
            part, least = 1.0, FINE / (math.hypot(aim_x - x, aim_y - y) + FINE)
            while part >= least:
                nx, ny = x + part * (aim_x - x), y + part * (aim_y - y)
                there = _segment_cell_cost(clearance, a[0], a[1], nx, ny, comfort, weight)
                there += _segment_cell_cost(clearance, nx, ny, b[0], b[1], comfort, weight)
                if (
                    there < now
                    and line_is_clear(ground, a[0], a[1], nx, ny, ground.radius)
                    and line_is_clear(ground, nx, ny, b[0], b[1], ground.radius)
                ):
                    points[i, 0], points[i, 1] = nx, ny
                    break
                part *= 0.5


@jit
def ease(points, ground, room) -> None:
    """Move the bends of a way (float64 n, 2) off what they go round, to ``room`` more than its radius where they can.

    What is seen and driven is not exact to the millimetre that the shortest way keeps.
    """
    enough = ground.radius + room
    for i in range(1, points.shape[0] - 1):
        x, y = points[i, 0], points[i, 1]
        away = square_distance(ground.occupied, x, y, enough)
        dx = square_distance(ground.occupied, x + NUDGE, y, enough + NUDGE) - away
        dy = square_distance(ground.occupied, x, y + NUDGE, enough + NUDGE) - away
        length = math.hypot(dx, dy)
        if away >= enough or length == 0.0:
            continue
        part = enough - away
        while part > 0.1 * room:
            nx, ny = x + part * dx / length, y + part * dy / length
            if (
                square_distance(ground.occupied, nx, ny, enough) >= away + 0.9 * part
                and line_is_clear(ground, points[i - 1, 0], points[i - 1, 1], nx, ny, ground.radius)
                and line_is_clear(ground, nx, ny, points[i + 1, 0], points[i + 1, 1], ground.radius)
            ):
                points[i, 0], points[i, 1] = nx, ny
                break
            part *= 0.5
