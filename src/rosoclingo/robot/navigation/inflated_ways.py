"""Ways on a map where cells near walls cost more, as navfn drives them on a costmap with an inflation layer."""

import math
from typing import List, NamedTuple, Optional, Sequence

import numpy as np

from rosoclingo.robot.navigation.compiled.marching import length_down, march
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D

__all__ = ["InflatedWays"]

INSCRIBED = 253  # costmap_2d's cost of a cell in which the robot's middle cannot be
NEUTRAL, FACTOR = 50.0, 0.8  # what navfn adds for each cell, and by what it takes the costmap's cost of it
NEAR = 3.0  # cells: so near to a pose in an inscribed cell a way to it ends


class _End(NamedTuple):
    """Where a way begins or ends (cells, 0 in the middle of the first), and how far beyond that the pose is."""

    row: float
    column: float
    beyond: float = 0.0


class InflatedWays:
    """The lengths of cheapest ways on a costmap, whose limits tell the inflation."""

    def __init__(self, costmap: Costmap) -> None:
        self._costmap = costmap
        self._costs = costs_of(costmap)

    def lengths_to(self, goal: Pose2D, starts: Sequence[Pose2D]) -> List[Optional[float]]:
        """Return the length (m) of the way from each of the poses to one; None where none is found."""
        last = self._joined(goal)
        if last is None:
            return [None] * len(starts)
        found = march(self._costs, math.floor(last.row + 0.5), math.floor(last.column + 0.5))
        return [self._length(found, one, last) for one in map(self._joined, starts)]

    def _length(self, found: np.ndarray, first: Optional[_End], last: _End) -> Optional[float]:
        if first is None:
            return None
        length = length_down(found, first.row, first.column, last.row, last.column) + first.beyond + last.beyond
        return float(length) * self._costmap.resolution if math.isfinite(length) else None

    def _joined(self, pose: Pose2D) -> Optional[_End]:
        x, y = self._costmap.to_cells(pose.x, pose.y)
        end = _End(y - 0.5, x - 0.5)
        row, column = math.floor(y), math.floor(x)
        height, width = self._costs.shape
        if 0 <= row < height and 0 <= column < width and math.isfinite(self._costs[row, column]):
            return end
        free = np.argwhere(np.isfinite(self._costs))
        gaps = np.hypot(*(free - (end.row, end.column)).T)
        if not len(gaps) or gaps.min() > NEAR:
            return None
        row, column = free[gaps.argmin()]
        return _End(float(row), float(column), float(gaps.min()))


def costs_of(costmap: Costmap) -> np.ndarray:
    """Return what a way of the length of a cell costs in each cell (float64, rows x columns), 1 far from walls.

    As costmap_2d has it, what is near a wall is measured from the middle of a cell to that of the nearest occupied one.
    """
    limits, shown = costmap.limits, costmap.costs()
    room = (costmap.clearance + 0.5) * costmap.resolution
    inflated = (INSCRIBED - 1) * np.exp(-limits.cost_scaling_factor * np.maximum(room - limits.robot_radius, 0.0))
    costs = 1.0 + FACTOR * np.where(room <= limits.inflation_radius, inflated, 0.0) / NEUTRAL
    return np.where((shown >= 0) & (shown < 100) & (room > limits.robot_radius), costs, np.inf).astype(np.float64)
