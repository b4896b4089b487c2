"""Global planners: from a start to a goal on a costmap."""

import enum
import math
from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from rosoclingo.navigation.compiled_search import find_cells, nearest_clear_cell
from rosoclingo.navigation.compiled_straightening import straighten, tighten
from rosoclingo.navigation.costmap import Costmap
from rosoclingo.navigation.geometry import Pose2D
from rosoclingo.navigation.landmarks import Landmarks, Tariff

__all__ = ["GlobalPlanner", "GridPlanner", "GridPlannerLimits", "Plan", "PlanOutcome"]

ROUNDS = 6  # of pulling a path tight


class PlanOutcome(enum.Enum):
    """Why a planner answers as it does."""

    FOUND = "found"
    START_OFF_MAP = "the robot is outside of the map"
    GOAL_OFF_MAP = "the goal is outside of the map"
    START_BLOCKED = "the robot is too close to an obstacle, and nowhere near it can it stand"
    GOAL_IN_OBSTACLE = "the goal is in an obstacle of the map, or closer to one than the robot's radius"
    GOAL_IN_UNMAPPED = "the goal is taken: something that is not on the map stands there"
    NO_PATH = "no path leads to the goal on the map"
    BLOCKED = "every path to the goal is blocked by something that is not on the map"

    @property
    def on_map(self) -> bool:
        """Whether the map alone is the reason, so that waiting or clearing cannot help."""
        return self in (PlanOutcome.GOAL_OFF_MAP, PlanOutcome.GOAL_IN_OBSTACLE, PlanOutcome.NO_PATH)


class Plan(NamedTuple):
    """What a planner found: ``points`` (float64 n, 2; x, y in m in the map's frame), empty unless FOUND."""

    outcome: PlanOutcome
    points: np.ndarray

    @property
    def length(self) -> float:
        """Length of the path in m."""
        return float(np.hypot(*np.diff(self.points, axis=0).T).sum()) if len(self.points) > 1 else 0.0


class GridPlannerLimits(NamedTuple):
    """Settings of :class:`GridPlanner`; lengths in m.

    ``comfort_weight``: a path next to a wall costs up to (1 + weight) times one that keeps ``comfort_distance``.
    ``default_tolerance``: how far from a goal that cannot be reached the path may end, 0: not at all (as navfn).
    ``escape_distance``: how far the robot may be from a place with clearance and still set off.
    ``spacing``: distance between the points of a path.
    """

    comfort_weight: float = 0.3
    comfort_distance: float = 0.45
    default_tolerance: float = 0.0
    escape_distance: float = 0.5
    spacing: float = 0.25


class GlobalPlanner:
    """What a global planner plugin does: subclasses are named by class path in ``base_global_planner``.

    It is made with its parameters, the mapping under the last part of its class path.
    """

    def __init__(self, parameters: Optional[dict] = None) -> None:
        self.parameters = dict(parameters or {})

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, tolerance: Optional[float] = None) -> Plan:
        """Return a path, or why there is none. ``tolerance`` (m) is default_tolerance unless given."""
        raise NotImplementedError

    def prepare(self, costmap: Costmap) -> None:
        """Do some of what makes later plans faster; called again and again while nothing is driven. Be brief."""


class GridPlanner(GlobalPlanner):
    """Cheapest path by A* on the clearance field, straightened: never closer to anything than the robot's radius."""

    def __init__(self, parameters: Optional[dict] = None) -> None:
        super().__init__(parameters)
        self.limits = GridPlannerLimits(**self.parameters)
        self._landmarks: Optional[Landmarks] = None

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, tolerance: Optional[float] = None) -> Plan:
        """Return the path; see :class:`GlobalPlanner`."""
        found = self._plan_on(costmap, costmap.clearance, start, goal, tolerance)
        if found.outcome is not PlanOutcome.NO_PATH or not costmap.has_marks:
            return found
        # Whom to blame: is there a way on the map alone?
        alone = self._plan_on(costmap, costmap.static_clearance, start, goal, tolerance)
        return _failed(PlanOutcome.BLOCKED if alone.outcome is PlanOutcome.FOUND else alone.outcome)

    def _plan_on(
        self, costmap: Costmap, clearance: np.ndarray, start: Pose2D, goal: Pose2D, tolerance: Optional[float]
    ) -> Plan:
        """Plan on one clearance field."""
        if not costmap.grid.contains(start.x, start.y):
            return _failed(PlanOutcome.START_OFF_MAP)
        if not costmap.grid.contains(goal.x, goal.y):
            return _failed(PlanOutcome.GOAL_OFF_MAP)
        least = least_clearance(costmap)
        start_cell = self._near(costmap, clearance, start, least, self.limits.escape_distance)
        reach = self.limits.default_tolerance if tolerance is None else max(0.0, tolerance)
        goal_cell = self._near(costmap, clearance, goal, least, reach)
        if goal_cell is None:
            on_map = costmap.static_clearance[costmap.grid.cell(goal.x, goal.y)] < least
            return _failed(PlanOutcome.GOAL_IN_OBSTACLE if on_map else PlanOutcome.GOAL_IN_UNMAPPED)
        if start_cell is None:
            return _failed(PlanOutcome.START_BLOCKED)
        tariff = self._tariff(costmap)
        cells = find_cells(clearance, *tariff, *start_cell, *goal_cell, self._costs_of_landmarks(costmap, tariff))
        if not len(cells):
            return _failed(PlanOutcome.NO_PATH)
        ends = (self._end(costmap, clearance, start, start_cell), self._end(costmap, clearance, goal, goal_cell))
        body = (clearance, costmap.occupied, costmap.limits.robot_radius / costmap.resolution, *tariff[1:])
        points = straighten(_path(cells, ends), *body)
        tighten(points, *body, ROUNDS)
        points = straighten(points, *body)
        return Plan(PlanOutcome.FOUND, self._in_metres(costmap, points))

    def prepare(self, costmap: Costmap) -> None:
        """Find landmarks on the map, part by part; see :class:`GlobalPlanner`."""
        if self._landmarks is None or self._landmarks.clearance is not costmap.static_clearance:
            self._landmarks = Landmarks(costmap.static_clearance, self._tariff(costmap))
        self._landmarks.go_on()

    def _costs_of_landmarks(self, costmap: Costmap, tariff: Tariff) -> np.ndarray:
        """Return what the search is led by (float32; cells, n), n 0 where nothing has been prepared for this map."""
        found = self._landmarks
        if found is None or found.clearance is not costmap.static_clearance or found.tariff != tariff:
            return np.empty((costmap.static_clearance.size, 0), dtype=np.float32)
        return found.costs

    def _tariff(self, costmap: Costmap) -> Tariff:
        comfort = min(self.limits.comfort_distance + costmap.limits.robot_radius, costmap.limits.inflation_radius)
        return Tariff(least_clearance(costmap), comfort / costmap.resolution, self.limits.comfort_weight)

    @staticmethod
    def _near(
        costmap: Costmap, clearance: np.ndarray, pose: Pose2D, least: float, reach: float
    ) -> Optional[Tuple[int, int]]:
        """Return the nearest cell to a pose that the robot can stand on, at most ``reach`` m away."""
        row, column = costmap.grid.cell(pose.x, pose.y)
        row, column = nearest_clear_cell(clearance, least, row, column, reach / costmap.resolution)
        return (row, column) if row >= 0 else None

    @staticmethod
    def _end(
        costmap: Costmap, clearance: np.ndarray, pose: Pose2D, cell: Tuple[int, int]
    ) -> Optional[Tuple[float, float]]:
        """Return the pose's own position in cells where the path may end exactly there, else None for the centre."""
        if costmap.grid.cell(pose.x, pose.y) != cell:
            return None
        x, y = costmap.to_cells(pose.x, pose.y)
        off_centre = math.hypot(x - cell[1] - 0.5, y - cell[0] - 0.5)
        return (x, y) if clearance[cell] - off_centre >= costmap.limits.robot_radius / costmap.resolution else None

    def _in_metres(self, costmap: Costmap, points: np.ndarray) -> np.ndarray:
        """Return the points in m, with more of them put in at ``spacing``."""
        metres = points * costmap.resolution + (costmap.grid.origin_x, costmap.grid.origin_y)
        return dense(metres, self.limits.spacing)


def least_clearance(costmap: Costmap) -> float:
    """Return the clearance (cells) of cell centres between which straight steps keep the robot's radius clear."""
    return math.sqrt((costmap.limits.robot_radius / costmap.resolution) ** 2 + 0.5)


def dense(points: np.ndarray, spacing: float) -> np.ndarray:
    """Return points (n, 2) with the gaps between them divided evenly, into parts no longer than ``spacing``."""
    if len(points) < 2:
        return points
    parts: List[np.ndarray] = []
    for a, b in zip(points[:-1], points[1:]):
        count = max(1, math.ceil(math.hypot(*(b - a)) / spacing))
        parts.append(a + (b - a) * (np.arange(count)[:, None] / count))
    return np.concatenate([*parts, points[-1:]])


def _failed(outcome: PlanOutcome) -> Plan:
    return Plan(outcome, np.empty((0, 2)))


def _path(cells: np.ndarray, ends: Tuple[Optional[Tuple[float, float]], Optional[Tuple[float, float]]]) -> np.ndarray:
    """Return cell centres as points (x, y in cells), the first and last one replaced by the true ends."""
    points = cells[:, ::-1] + 0.5
    if len(points) == 1:
        points = np.repeat(points, 2, axis=0)
    for index, end in ((0, ends[0]), (-1, ends[1])):
        if end is not None:
            points[index] = end
    return np.ascontiguousarray(points, dtype=np.float64)
