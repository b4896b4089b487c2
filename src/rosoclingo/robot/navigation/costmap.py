"""What is known to be in the way: the static map, and what the laser saw that the map lacks."""

import copy
import math
from collections import deque
from typing import Deque, NamedTuple, Optional, Tuple

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import inflate, update_clearance, update_open
from rosoclingo.robot.navigation.compiled.marks import count_scan, hits_apart
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import OCCUPIED, OccupancyGrid

Window = Tuple[int, int, int, int]
EMPTY: Window = (0, 0, 0, 0)
SPARE = 0.015  # m that ways keep free beside the robot's radius: what is seen and driven is not exact to the millimetre
BAR = 0.1  # m around a point that is barred
NEARBY = 1.5  # m: what is hit within it and not marked yet is kept, for who has to brake
SCANS = 3  # for so many scans: what is seen edge on is not hit in each


class CostmapLimits(NamedTuple):
    """How the costmap reads map and laser; lengths in m. Names and meanings as in costmap_2d.

    ``static_tolerance`` is this costmap's own: a hit that near to something on the map is that thing, not a new one,
    so that noise does not make walls thicker and doors narrower; while the robot turns it is more, up to
    ``most_tolerance``. So are ``way_radii``, what ways keep free, widest first: each where there is no way by those
    before it; empty for ``robot_radius`` alone.
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
    way_radii: Tuple[float, ...] = ()


class Ground(NamedTuple):
    """What a planner plans on: ``open`` (uint8 H, W), the cells in which the robot keeps ``radius`` cells free."""

    open: np.ndarray
    radius: float


class Costmap:
    """A grid with a clearance field: for each cell the distance to the nearest obstacle, cut off at ``reach``.

    ``clearance`` is float32 (height, width) in cells (see ``update_clearance``). ``grounds`` are what planners plan on,
    for each of the radii to plan with: off what is ``closed`` (bool): bars, and unknown cells unless they are allowed.
    ``unmarked`` (n, 2; m) is what the last few scans hit nearby that is neither on the map nor marked yet.
    """

    def __init__(self, grid: OccupancyGrid, limits: Optional[CostmapLimits] = None) -> None:
        self.grid = grid
        self.limits = limits or CostmapLimits()
        self.resolution = grid.resolution
        radii = self.limits.way_radii or (self.limits.robot_radius,)
        self.reach = (max(self.limits.inflation_radius, *radii) + 0.1) / grid.resolution + 2.0
        self._static = grid.occupied(self.limits.lethal_threshold)
        self._unknown = (grid.cells < 0) & (not self.limits.allow_unknown)
        self.occupied = self._static.copy()
        self.marks = np.zeros(grid.shape, dtype=np.uint8)
        self.clearance = np.empty(grid.shape, dtype=np.float32)
        self.has_marks = False
        self._counts = np.zeros(grid.shape, dtype=np.uint8)
        self.closed = self._unknown.copy()
        self._has_bars = False
        self.grounds = tuple(
            Ground(np.zeros(grid.shape, dtype=np.uint8), (radius + SPARE) / grid.resolution) for radius in radii
        )
        self._refresh((0, grid.shape[0], 0, grid.shape[1]), margin=0)
        self._static_clearance = self.clearance.copy()
        self._alone: Optional[Costmap] = None
        self.unmarked = np.empty((0, 2))
        self._unmarked: Deque[np.ndarray] = deque(maxlen=SCANS)

    def snapshot(self) -> "Costmap":
        """Return a costmap to plan on that stays as this one is now. Nothing may be entered into it."""
        twin = copy.copy(self)
        twin.clearance, twin.occupied, twin.marks = self.clearance.copy(), self.occupied.copy(), self.marks.copy()
        twin.grounds = tuple(ground._replace(open=ground.open.copy()) for ground in self.grounds)
        return twin

    def alone(self) -> "Costmap":
        """Return a costmap of the map alone, without what the laser saw and without bars."""
        if self._alone is None:
            self._alone = Costmap(self.grid, self.limits)
        return self._alone

    def to_cells(self, x: float, y: float) -> Tuple[float, float]:
        """Return a point (m) in cells, as the compiled functions take it."""
        return (x - self.grid.origin_x) / self.resolution, (y - self.grid.origin_y) / self.resolution

    def to_metres(self, x: float, y: float) -> Tuple[float, float]:
        """Return a point (cells) in m."""
        return self.grid.origin_x + x * self.resolution, self.grid.origin_y + y * self.resolution

    def all_to_cells(self, points: np.ndarray) -> np.ndarray:
        """Return points (float64 n, 2; m) in cells."""
        return (points - (self.grid.origin_x, self.grid.origin_y)) / self.resolution

    def observe(
        self, sensor: Pose2D, angles: np.ndarray, ranges: np.ndarray, range_max: float, smear: float = 0.0
    ) -> bool:
        """Mark what a scan hit and clear what it looked through; tell whether anything changed.

        ``sensor`` is the laser's pose in the map's frame, ``angles`` (rad, float64) are relative to it, ``ranges``
        in m. A range of ``range_max`` or more, or infinity, hit nothing; NaN and negative ones are left out.
        ``smear`` (rad) is by how much all directions may be wrong, as those of a robot that turns: rays end where that
        would be more than ``most_tolerance``, and what may be something on the map is that.
        """
        good = ~np.isnan(ranges) & (ranges >= 0.0)
        turned = np.asarray(angles[good] + sensor.yaw, dtype=np.float64)
        far = np.asarray(ranges[good], dtype=np.float64)
        x, y = self.to_cells(sensor.x, sensor.y)
        most = self.limits.most_tolerance
        sharp = most / smear if smear > 0.0 else math.inf
        hits = far < min(self.limits.obstacle_range, range_max - 1e-3, sharp)
        # What is hit is marked where it is, however far off clearing ends.
        ends = np.where(hits, far, np.minimum(far, min(self.limits.raytrace_range, range_max, sharp)))
        known = (self.limits.static_tolerance + min(smear * self.limits.obstacle_range, most)) / self.resolution
        lengths = ends / self.resolution + 1e-3
        changed = count_scan(
            self._counts, self.marks, self._static, self._static_clearance, x, y, turned, lengths, hits, known
        )
        self._changed(changed)
        # What is neither on the map nor marked yet.
        scale = self.resolution
        seen = hits_apart(self.occupied, self.clearance, x, y, turned, far / scale, hits, NEARBY / scale, known)
        self._unmarked.append(seen * self.resolution + (self.grid.origin_x, self.grid.origin_y))
        self.unmarked = np.concatenate(self._unmarked)
        return bool(changed != EMPTY)

    def forget(self, x: float, y: float, beyond: float = 0.0) -> bool:
        """Drop what the laser marked further than ``beyond`` m (in x or y) from a point; tell whether any was."""
        row, column = self.grid.cell(x, y)
        span = round(beyond / self.resolution)
        kept = np.zeros_like(self.marks)
        near = (slice(max(0, row - span), max(0, row + span)), slice(max(0, column - span), max(0, column + span)))
        if span > 0:
            kept[near] = self.marks[near]
        dropped = np.argwhere(self.marks != kept)
        self.marks[:] = kept
        self._counts *= kept
        self._changed(_window_of(dropped))
        return len(dropped) > 0

    def bar(self, x: float, y: float) -> None:
        """Keep paths, where there are others, off a point (m) at which one has turned out to be blocked."""
        row, column = self.grid.cell(x, y)
        window = self._widened((row, row + 1, column, column + 1), math.ceil(BAR / self.resolution))
        rows, columns = np.mgrid[window[0] : window[1], window[2] : window[3]]
        self.closed[rows, columns] |= np.hypot(rows - row, columns - column) * self.resolution <= BAR
        self._has_bars = True
        self._update_grounds(window)

    def unbar(self) -> bool:
        """Take all bars away; tell whether there were any."""
        if not self._has_bars:
            return False
        self._has_bars = False
        barred = np.argwhere(self.closed != self._unknown)
        self.closed[:] = self._unknown
        self._update_grounds(_window_of(barred))
        return True

    def costs(self, first: Optional[Pose2D] = None, shape: Optional[Tuple[int, int]] = None) -> np.ndarray:
        """Return occupancy as navigation's costmap topics show it (int8: 100 lethal, 99 inscribed, .. 0 free, -1).

        Of the whole grid, or of cells of its size in any ``shape`` (rows, columns) and direction: ``first`` is the pose
        (m, rad) of the first one's centre. Off the grid it is -1.
        """
        x, y = (0.5, 0.5) if first is None else self.to_cells(first.x, first.y)
        yaw = 0.0 if first is None else first.yaw
        limits, scale = self.limits, self.resolution
        lengths = (limits.robot_radius / scale, limits.inflation_radius / scale, limits.cost_scaling_factor * scale)
        costs = np.empty(shape or self.grid.shape, dtype=np.int8)
        inflate(self.clearance, self.occupied, self._unknown, x, y, yaw, *lengths, costs)
        return costs

    def _changed(self, window: Window) -> None:
        """Bring occupancy and clearance up to date after marks changed within a window."""
        if window != EMPTY:
            self._refresh(window, margin=math.ceil(self.reach) + 1)
            self.has_marks = bool(self.marks.any())

    def _refresh(self, window: Window, margin: int) -> None:
        row0, row1, column0, column1 = window
        part = (slice(row0, row1), slice(column0, column1))
        self.occupied[part] = self._static[part] | self.marks[part]
        window = self._widened(window, margin)
        update_clearance(self.occupied, self.reach, *window, self.clearance)
        self._update_grounds(window)

    def _update_grounds(self, window: Window) -> None:
        for ground in self.grounds:
            update_open(self.clearance, self.occupied, self.closed, ground.radius, *window, ground.open)

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
