"""Path lengths of navfn on a costmap with an inflation layer, where cells near walls cost more."""

import math
from typing import List, Optional, Sequence

import numpy as np

from rosoclingo.robot.navigation.compiled.marching import descend, march
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D

INSCRIBED = 253  # costmap_2d: cost of cells in which the robot's centre cannot be
NEUTRAL, FACTOR = 50.0, 0.8  # navfn: cost of each cell, and factor of its costmap cost


def navfn_lengths(costmap: Costmap, goal: Pose2D, starts: Sequence[Pose2D]) -> List[Optional[float]]:
    """Return the length (m) of the cheapest path from each start to the goal; None where navfn finds none."""
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
    way = descend(found, *ends)
    return float(np.hypot(*np.diff(way, axis=0).T).sum()) * costmap.resolution


def _costs(costmap: Costmap) -> np.ndarray:
    """Return the cost of each cell (float32, rows x columns) per cell length, 1 far from walls.

    As in costmap_2d, distances are measured between the centres of cells.
    """
    limits, shown = costmap.limits, costmap.costs()
    room = (costmap.clearance + 0.5) * costmap.resolution
    inflated = (INSCRIBED - 1) * np.exp(-limits.cost_scaling_factor * np.maximum(room - limits.robot_radius, 0.0))
    costs = 1.0 + FACTOR * np.where(room <= limits.inflation_radius, inflated, 0.0) / NEUTRAL
    return np.where((shown >= 0) & (shown < 100) & (room > limits.robot_radius), costs, np.inf).astype(np.float32)
