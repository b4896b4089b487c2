"""Ways on a map where cells near walls cost more, as navfn drives them on a costmap with an inflation layer."""

import math
from typing import List, Optional, Sequence

import numpy as np

from rosoclingo.robot.navigation.compiled.marching import march, way_down
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D

INSCRIBED = 253  # costmap_2d's cost of a cell in which the robot's middle cannot be
NEUTRAL, FACTOR = 50.0, 0.8  # what navfn adds for each cell, and by what it takes the costmap's cost of it


def navfn_lengths(costmap: Costmap, goal: Pose2D, starts: Sequence[Pose2D]) -> List[Optional[float]]:
    """Return the length (m) of the cheapest way from each of the poses to one; None where navfn finds none."""
    costs = _costs(costmap)
    row, column = costmap.grid.cell(goal.x, goal.y)
    if not costmap.grid.contains(goal.x, goal.y) or not math.isfinite(costs[row, column]):
        return [None] * len(starts)
    found = march(costs, row, column, -1, -1, np.zeros(1, dtype=bool))
    return [_length(costmap, found, start, goal) for start in starts]


def _length(costmap: Costmap, found: np.ndarray, start: Pose2D, goal: Pose2D) -> Optional[float]:
    if not costmap.grid.contains(start.x, start.y) or not math.isfinite(found[costmap.grid.cell(start.x, start.y)]):
        return None
    ends = (coordinate - 0.5 for pose in (start, goal) for coordinate in costmap.to_cells(pose.x, pose.y)[::-1])
    way = way_down(found, *ends)
    return float(np.hypot(*np.diff(way, axis=0).T).sum()) * costmap.resolution


def _costs(costmap: Costmap) -> np.ndarray:
    """Return what a way of the length of a cell costs in each cell (float32, rows x columns), 1 far from walls.

    As costmap_2d has it, what is near a wall is measured from the middle of a cell to that of the nearest occupied one.
    """
    limits, shown = costmap.limits, costmap.costs()
    room = (costmap.clearance + 0.5) * costmap.resolution
    inflated = (INSCRIBED - 1) * np.exp(-limits.cost_scaling_factor * np.maximum(room - limits.robot_radius, 0.0))
    costs = 1.0 + FACTOR * np.where(room <= limits.inflation_radius, inflated, 0.0) / NEUTRAL
    return np.where((shown >= 0) & (shown < 100) & (room > limits.robot_radius), costs, np.inf).astype(np.float32)
