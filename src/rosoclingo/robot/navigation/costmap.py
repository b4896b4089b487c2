"""What is known to be in the way: the static map, and what the laser saw that the map lacks."""

import copy
import math
from collections import deque
from typing import Deque, List, NamedTuple, Optional, Tuple

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import inflate, update_clearance
from rosoclingo.robot.navigation.compiled.marks import Evidence, Mapped, Rules, count_rays, hits_apart
from rosoclingo.robot.navigation.compiled.places import Ground, update_places
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import OCCUPIED, OccupancyGrid
from rosoclingo.robot.navigation.scan_noise import ScanNoise

__all__ = ["SPARE", "Costmap", "CostmapLimits", "Window"]

Window = Tuple[int, int, int, int]
EMPTY: Window = (0, 0, 0, 0)
# A hit counts for so many rays that pass; from SURE on a cell is marked, and LIMIT is as sure as it gets: what hits in
# less than a third of all scans is noise, and what has gone is forgotten after LIMIT rays have passed.
GAIN, SURE, LIMIT = 2, 12, 24
NEAR = 0.01  # m: a ray that passes so near to what was hit shows that it has gone
SPARE = 0.005  # m that ways keep free beside the robot's radius: no robot drives along a wall that it touches
SCATTER = 3.5  # times the standard deviation of the laser's noise
BAR = 0.1  # m around a point that is barred
NEARBY = 1.5  # m: what is hit within it and not marked yet is kept, for who has to brake
SCANS = 3  # for so many scans: what is seen edge on is not hit in each


class CostmapLimits(NamedTuple):
    """How the costmap reads map and laser; lengths in m. Names and meanings as in costmap_2d.

    ``static_tolerance`` is this costmap's own: a hit that near to something on the map is that thing, not a new one,
    so that noise does not make walls thicker and doors narrower; with a noisy laser it is more, up to
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


class Costmap:
    """A grid with a clearance field: for each cell the distance to the nearest obstacle, cut off at ``reach``.

    ``clearance`` is float32 (height, width) in cells (see ``update_clearance``).
    ``grounds`` are what planners plan on, with that clearance, for each of the radii to plan with: off unknown cells,
    unless these are allowed, and off what is barred; ``static_grounds`` are the same for the map alone.
    ``unmarked`` (n, 2; m) is what the last few scans hit nearby that is neither on the map nor marked yet.
    """

    def __init__(self, grid: OccupancyGrid, limits: Optional[CostmapLimits] = None) -> None:
        self.grid = grid
        self.limits = limits or CostmapLimits()
        self.resolution = grid.resolution
        radii = self.limits.way_radii or (self.limits.robot_radius,)
        self.reach = (max(self.limits.inflation_radius, *radii) + 0.1) / grid.resolution + 2.0
        static = grid.occupied(self.limits.lethal_threshold)
        self._closed = (grid.cells < 0) & (not self.limits.allow_unknown)
        self._occupied = static.copy()
        counts, marks = np.zeros((2, *grid.shape), dtype=np.uint8)
        self._evidence = Evidence(counts, marks, np.zeros((*grid.shape, 2), dtype=np.uint8))
        self._marked = 0
        self._static = static
        self._noise = ScanNoise()
        self.clearance = np.empty(grid.shape, dtype=np.float32)
        self._has_bars, self._stale = False, EMPTY  # of the latter: what has changed since the twin was told
        self._barred = self._closed.view(np.uint8).copy()
        self._inland = np.empty(grid.shape, dtype=np.float32)
        whole = (0, grid.shape[0], 0, grid.shape[1])
        if self._barred.any():
            update_clearance(self._barred, self.reach, *whole, self._inland)
        else:  # a large map that is known all over is ready so much sooner
            self._inland.fill(self.reach)
        blank = Ground(self.clearance, self._occupied, self._inland, self._barred, 0.0)
        self.grounds = tuple(
            blank._replace(places=np.zeros(grid.shape, np.uint8), radius=(radius + SPARE) / grid.resolution)
            for radius in radii
        )
        self._refresh(whole, margin=0)
        alone = blank._replace(clearance=self.clearance.copy(), occupied=static, inland=self._inland.copy())
        self.static_grounds = tuple(
            alone._replace(places=ground.places.copy(), radius=ground.radius) for ground in self.grounds
        )
        self._mapped = Mapped(static, alone.clearance)
        self._known = Mapped(self._occupied, self.clearance)
        self.unmarked = np.empty((0, 2))
        self._unmarked: Deque[np.ndarray] = deque(maxlen=SCANS)

    def twin(self) -> "Costmap":
        """Return a costmap to plan on while this one goes on to change, as it is now; there is one at a time.

        It learns of changes by ``catch_up`` alone. Nothing may be entered into it.
        """
        twin = copy.copy(self)
        twin.clearance, twin._occupied = self.clearance.copy(), self._occupied.copy()
        twin._inland, twin._barred = self._inland.copy(), self._barred.copy()
        twin._evidence = self._evidence._replace(marks=self.marks.copy())
        own = (twin.clearance, twin._occupied, twin._inland)
        twin.grounds = tuple(Ground(*own, ground.places.copy(), ground.radius) for ground in self.grounds)
        self._stale = EMPTY
        return twin

    def catch_up(self, source: "Costmap") -> None:
        """Take over, as the twin of another costmap, what has changed there; nobody may plan on this one meanwhile."""
        row0, row1, column0, column1 = source._stale
        part = (slice(row0, row1), slice(column0, column1))
        for mine, new in zip(self._layers(), source._layers()):
            mine[part] = new[part]
        self._marked, self._has_bars, self.unmarked = source._marked, source._has_bars, source.unmarked
        source._stale = EMPTY

    def _layers(self) -> List[np.ndarray]:
        """Return all arrays that change and that a planner may read."""
        places = [ground.places for ground in self.grounds]
        return [self.clearance, self._occupied, self._inland, self._barred, self.marks, *places]

    @property
    def has_marks(self) -> bool:
        """Whether the laser has put anything on the costmap that is still there."""
        return self._marked > 0

    @property
    def occupied(self) -> np.ndarray:
        """The cells (uint8, non-zero) that the map or the laser says are occupied."""
        return self._occupied

    @property
    def marks(self) -> np.ndarray:
        """The cells (uint8, non-zero) that the laser marked."""
        return self._evidence.marks

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
        lengths = ends / self.resolution + 1e-3
        self._noise.see(np.where(hits, far, np.nan))
        known = (self._tolerance() + min(smear * self.limits.obstacle_range, most)) / self.resolution
        spacing = float(abs(angles[-1] - angles[0])) / max(1, len(angles) - 1) if len(angles) else 0.0
        rules = Rules(GAIN, LIMIT, SURE, known, NEAR / self.resolution, spacing)
        window = count_rays(self._evidence, self._mapped, x, y, turned, lengths, hits, rules)
        changed = self._changed(window)
        # What is neither on the map nor marked yet.
        seen = hits_apart(self._known, x, y, turned, far / self.resolution, hits, NEARBY / self.resolution, known)
        self._unmarked.append(seen * self.resolution + (self.grid.origin_x, self.grid.origin_y))
        self.unmarked = np.concatenate(self._unmarked)
        return changed

    def _tolerance(self) -> float:
        """Return how near (m) to something on the map a hit is that thing: nearly all of what noise scatters is."""
        least = self.limits.static_tolerance
        return max(least, min(SCATTER * self._noise.deviation, self.limits.most_tolerance))

    def forget(self, x: float, y: float, beyond: float = 0.0) -> bool:
        """Drop what the laser marked further than ``beyond`` m (in x or y) from a point; tell whether any was."""
        if not self._marked:
            return False
        row, column = self.grid.cell(x, y)
        span = round(beyond / self.resolution)
        kept = np.zeros_like(self.marks)
        near = (slice(max(0, row - span), max(0, row + span)), slice(max(0, column - span), max(0, column + span)))
        if span > 0:
            kept[near] = self.marks[near]
        dropped = np.argwhere(self.marks != kept)
        self.marks[:] = kept
        self._evidence.counts[:] *= kept
        return self._changed(_window_of(dropped))

    def bar(self, x: float, y: float) -> None:
        """Keep paths, where there are others, off a point (m) at which one has turned out to be blocked."""
        row, column = self.grid.cell(x, y)
        window = self._widened((row, row + 1, column, column + 1), math.ceil(BAR / self.resolution))
        rows, columns = np.mgrid[window[0] : window[1], window[2] : window[3]]
        self._barred[rows, columns] |= np.hypot(rows - row, columns - column) * self.resolution <= BAR
        self._has_bars = True
        self._bars_changed(window)

    def unbar(self) -> bool:
        """Take all bars away; tell whether there were any."""
        if not self._has_bars:
            return False
        self._has_bars = False
        barred = np.argwhere(self._barred != self._closed)
        self._barred[:] = self._closed
        self._bars_changed(_window_of(barred))
        return True

    def _bars_changed(self, window: Window) -> None:
        window = self._widened(window, math.ceil(self.reach) + 1)
        update_clearance(self._barred, self.reach, *window, self._inland)
        self._update_places(window)

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
        inflate(self.clearance, self._occupied, self._closed, x, y, yaw, *lengths, costs)
        return costs

    def _changed(self, window: Window) -> bool:
        """Bring occupancy and clearance up to date after marks changed within a window."""
        if window == EMPTY:
            return False
        self._refresh(window, margin=math.ceil(self.reach) + 1)
        self._marked = int(np.count_nonzero(self.marks))
        return True

    def _refresh(self, window: Window, margin: int) -> None:
        row0, row1, column0, column1 = window
        part = (slice(row0, row1), slice(column0, column1))
        self._occupied[part] = self._static[part] | self.marks[part]
        window = self._widened(window, margin)
        update_clearance(self._occupied, self.reach, *window, self.clearance)
        self._update_places(window)

    def _update_places(self, window: Window) -> None:
        self._stale = _around_both(self._stale, window)
        for ground in self.grounds:
            update_places(ground, *window)

    def _widened(self, window: Window, margin: int) -> Window:
        row0, row1, column0, column1 = window
        height, width = self.grid.shape
        return max(0, row0 - margin), min(height, row1 + margin), max(0, column0 - margin), min(width, column1 + margin)


def _around_both(a: Window, b: Window) -> Window:
    """Return the least window around two."""
    if EMPTY in (a, b):
        return b if a == EMPTY else a
    return min(a[0], b[0]), max(a[1], b[1]), min(a[2], b[2]), max(a[3], b[3])


def _window_of(cells: np.ndarray) -> Window:
    """Return the half-open window around cells (n, 2)."""
    if not len(cells):
        return EMPTY
    low, high = cells.min(axis=0), cells.max(axis=0) + 1
    return int(low[0]), int(high[0]), int(low[1]), int(high[1])
