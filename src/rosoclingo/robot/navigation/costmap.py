"""Costmap: the static map, and the obstacles that the laser has seen."""

import copy
import math
from collections import deque
from typing import Any, Deque, NamedTuple, Optional, Tuple

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import update_clearance, update_open
from rosoclingo.robot.navigation.compiled.marks import count_scan, hits_apart
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import OCCUPIED, OccupancyGrid

Window = Tuple[int, int, int, int]
EMPTY: Window = (0, 0, 0, 0)
SPARE = 0.015  # m: added to the robot's radius in planning, since sensing and driving are inexact
BAR_RADIUS = 0.1  # m: radius of a barred area
BRAKE_RANGE = 1.5  # m: range in which unmarked hits are kept, for braking
BRAKE_SCANS = 3  # number of scans for which unmarked hits are kept, as thin obstacles are not hit in every scan


class CostmapLimits(NamedTuple):
    """Settings of the costmap; lengths in m. Names and meanings are those of costmap_2d, with three additions.

    ``static_tolerance``: a hit within this distance of a mapped obstacle belongs to that obstacle. Without it, noise
    would make walls thicker and doors narrower. ``most_tolerance``: maximum addition to it while the robot turns.
    ``path_radii``: clearances of paths, widest first; each is tried if no path exists with the previous ones. Empty:
    ``robot_radius`` only.
    """

    robot_radius: float = 0.18
    inflation_radius: float = 0.55
    cost_scaling_factor: float = 10.0
    obstacle_range: float = 5.0
    raytrace_range: float = 6.0
    static_tolerance: float = 0.04
    most_tolerance: float = 0.1
    lethal_threshold: int = OCCUPIED
    allow_unknown: bool = False
    path_radii: Tuple[float, ...] = ()


class FreeSpace(NamedTuple):
    """Cells that are free for the robot: ``open`` (uint8 H, W), where it has a clearance of ``radius`` cells."""

    open: np.ndarray
    radius: float


class Costmap:
    """A grid with a clearance field: the distance of each cell to the nearest obstacle, at most ``reach``.

    ``clearance``: float32 (height, width), in cells; see ``update_clearance``.
    ``free_spaces``: the free cells for each planning radius, without ``closed`` cells.
    ``closed``: bool (height, width): barred cells, and unknown cells unless they are allowed.
    ``unmarked``: points (n, 2; m) of nearby obstacles in the last few scans that are neither mapped nor marked yet.
    """

    def __init__(self, grid: OccupancyGrid, limits: Optional[CostmapLimits] = None) -> None:
        self.grid = grid
        self.limits = limits or CostmapLimits()
        self.resolution = grid.resolution
        radii = self.limits.path_radii or (self.limits.robot_radius,)
        self.reach = (max(self.limits.inflation_radius, *radii) + 0.1) / grid.resolution + 2.0
        self._static = grid.occupied(self.limits.lethal_threshold)
        self._unknown = (grid.cells < 0) & (not self.limits.allow_unknown)
        self.occupied = self._static.copy()
        self.clearance = np.empty(grid.shape, dtype=np.float32)
        self._counts = np.zeros(grid.shape, dtype=np.uint8)
        self.closed = self._unknown.copy()
        self.free_spaces = tuple(
            FreeSpace(np.zeros(grid.shape, dtype=np.uint8), (radius + SPARE) / grid.resolution) for radius in radii
        )
        self._refresh((0, grid.shape[0], 0, grid.shape[1]))
        self._static_clearance = self.clearance.copy()
        self._static_costmap: Optional[Costmap] = None
        self.unmarked = np.empty((0, 2))
        self._unmarked: Deque[np.ndarray] = deque(maxlen=BRAKE_SCANS)

    def snapshot(self) -> "Costmap":
        """Return a copy for planning in another thread. It must not be modified."""
        twin = copy.copy(self)
        twin.clearance, twin.occupied = self.clearance.copy(), self.occupied.copy()
        twin.free_spaces = tuple(space._replace(open=space.open.copy()) for space in self.free_spaces)
        return twin

    def static(self) -> "Costmap":
        """Return a costmap of the static map, without marks of the laser and without barred areas."""
        if self._static_costmap is None:
            self._static_costmap = Costmap(self.grid, self.limits)
        return self._static_costmap

    @property
    def marks(self) -> np.ndarray:
        """The mask (bool H, W) of occupied cells that are not on the map."""
        return self.occupied > self._static

    @property
    def has_marks(self) -> bool:
        """Whether there are such cells."""
        return bool(self.marks.any())

    def to_cells(self, x: float, y: float) -> Tuple[float, float]:
        """Convert a point (m) to cells, the unit of the compiled functions."""
        return (x - self.grid.origin_x) / self.resolution, (y - self.grid.origin_y) / self.resolution

    def all_to_cells(self, points: np.ndarray) -> np.ndarray:
        """Convert points (float64 n, 2; m) to cells."""
        return (points - (self.grid.origin_x, self.grid.origin_y)) / self.resolution

    def observe(
        self, sensor: Pose2D, angles: np.ndarray, ranges: np.ndarray, range_max: float, smear: float = 0.0
    ) -> bool:
        """Enter a scan: mark the cells that it hits, clear those that it passes. Return whether any mark changed.

        ``sensor``: pose of the laser in the map frame. ``angles``: rad, float64, relative to the sensor. ``ranges``: m;
        a range of at least ``range_max`` is not a hit; NaN and negative values are ignored.

        ``smear``: maximum error (rad) of the directions, for a turning robot. Rays end where it would exceed
        ``most_tolerance``, and hits that could belong to a mapped obstacle are ignored.
        """
        good = ~np.isnan(ranges) & (ranges >= 0.0)
        turned = np.asarray(angles[good] + sensor.yaw, dtype=np.float64)
        far = np.asarray(ranges[good], dtype=np.float64)
        x, y = self.to_cells(sensor.x, sensor.y)
        most = self.limits.most_tolerance
        sharp = most / smear if smear > 0.0 else math.inf
        hits = far < min(self.limits.obstacle_range, range_max - 1e-3, sharp)
        # Hits mark at any distance; only clearing is limited to raytrace_range.
        ends = np.where(hits, far, np.minimum(far, min(self.limits.raytrace_range, range_max, sharp)))
        known = (self.limits.static_tolerance + min(smear * self.limits.obstacle_range, most)) / self.resolution
        lengths = ends / self.resolution + 1e-3
        changed = count_scan(
            self._counts, self.occupied, self._static, self._static_clearance, x, y, turned, lengths, hits, known
        )
        self._refresh(changed)
        # Hits that are neither mapped nor marked yet, for braking.
        scale = self.resolution
        seen = hits_apart(self.occupied, self.clearance, x, y, turned, far / scale, hits, BRAKE_RANGE / scale, known)
        self._unmarked.append(seen * self.resolution + (self.grid.origin_x, self.grid.origin_y))
        self.unmarked = np.concatenate(self._unmarked)
        return bool(changed != EMPTY)

    def forget(self, x: float, y: float, beyond: float = 0.0) -> None:
        """Drop marks further than ``beyond`` m (in x or y) from a point."""
        row, column = self.grid.cell(x, y)
        span = round(beyond / self.resolution)
        dropped = self.marks
        dropped[max(0, row - span) : max(0, row + span), max(0, column - span) : max(0, column + span)] = False
        self.occupied[dropped] = self._counts[dropped] = 0
        self._refresh(_window_of(np.argwhere(dropped)))

    def forget_under(self, x: float, y: float) -> None:
        """Drop marks whose middle is within the robot's radius of its position (m)."""
        radius, (row, column) = self.limits.robot_radius, self.grid.cell(x, y)
        window = self._widened((row, row + 1, column, column + 1), math.ceil(radius / self.resolution))
        part = (slice(window[0], window[1]), slice(window[2], window[3]))
        marks = self.occupied[part] > self._static[part]
        if marks.any():
            (cx, cy), (rows, columns) = self.to_cells(x, y), np.mgrid[part]
            dropped = marks & (np.hypot(rows + 0.5 - cy, columns + 0.5 - cx) * self.resolution < radius)
            if dropped.any():
                self.occupied[part][dropped] = self._counts[part][dropped] = 0
                self._refresh(window)

    def bar(self, x: float, y: float) -> None:
        """Close the area around a point (m) at which a path turned out to be blocked."""
        row, column = self.grid.cell(x, y)
        window = self._widened((row, row + 1, column, column + 1), math.ceil(BAR_RADIUS / self.resolution))
        rows, columns = np.mgrid[window[0] : window[1], window[2] : window[3]]
        self.closed[rows, columns] |= np.hypot(rows - row, columns - column) * self.resolution <= BAR_RADIUS
        self._update_free_spaces(window)

    def unbar(self) -> bool:
        """Open all barred areas. Return whether there were any."""
        barred = np.argwhere(self.closed != self._unknown)
        self.closed[:] = self._unknown
        self._update_free_spaces(_window_of(barred))
        return len(barred) > 0

    def costs(self, cells: Any = slice(None)) -> np.ndarray:
        """Return the costs of indexed cells as costmap topics publish them, by default of all.

        They are int8: 100 lethal, 99 inscribed .. 0 free, -1 unknown. Between ``robot_radius`` and ``inflation_radius``
        they decay exponentially.
        """
        limits, scale = self.limits, self.resolution
        room, radius = self.clearance[cells], limits.robot_radius / scale
        decay = 98.0 * np.exp(-limits.cost_scaling_factor * scale * np.maximum(room - radius, 0.0))
        kinds = [self.occupied[cells] > 0, self._unknown[cells], room < radius, room <= limits.inflation_radius / scale]
        return np.select(kinds, [100, -1, 99, np.maximum(decay, 1.0)], 0).astype(np.int8)

    def costs_around(self, first: Pose2D, shape: Tuple[int, int]) -> np.ndarray:
        """Return the costs (int8; rows, columns) of a window with cells of the same size; -1 off the grid.

        The first cell is centred at the pose ``first`` (m, rad), whose yaw is the direction of the rows.
        """
        (x, y), (i, j) = self.to_cells(first.x, first.y), np.indices(shape)
        c, s = math.cos(first.yaw), math.sin(first.yaw)
        columns = np.floor(x + c * j - s * i + 1e-6).astype(int)
        rows = np.floor(y + s * j + c * i + 1e-6).astype(int)
        height, width = self.grid.shape
        inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
        costs = np.full(shape, -1, dtype=np.int8)
        costs[inside] = self.costs((rows[inside], columns[inside]))
        return costs

    def _refresh(self, window: Window) -> None:
        """Update the clearance after cells within a window changed."""
        if window != EMPTY:
            window = self._widened(window, math.ceil(self.reach) + 1)
            update_clearance(self.occupied, self.reach, *window, self.clearance)
            self._update_free_spaces(window)

    def _update_free_spaces(self, window: Window) -> None:
        for space in self.free_spaces:
            update_open(self.clearance, self.occupied, self.closed, space.radius, *window, space.open)

    def _widened(self, window: Window, margin: int) -> Window:
        row0, row1, column0, column1 = window
        height, width = self.grid.shape
        return max(0, row0 - margin), min(height, row1 + margin), max(0, column0 - margin), min(width, column1 + margin)


def _window_of(cells: np.ndarray) -> Window:
    """Return the half-open window around cells (n, 2)."""
    if not len(cells):
        return EMPTY
    low, high = cells.min(axis=0), cells.max(axis=0) + 1
    return int(low[0]), int(high[0]), int(low[1]), int(high[1])
