"""Global planners: paths from a start to a goal on a costmap."""

import enum
import math
from typing import Iterator, NamedTuple, Optional, Tuple

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import square_distance
from rosoclingo.robot.navigation.compiled.marching import descend, ease, march, thin
from rosoclingo.robot.navigation.compiled.path import least_along
from rosoclingo.robot.navigation.costmap import SPARE, Costmap, FreeSpace
from rosoclingo.robot.navigation.geometry import Pose2D

JOIN_LIMIT = 3.0  # cells: maximum distance of a valid robot position from the nearest open cell
# Paths keep EXTRA_CLEARANCE (m) and half a cell more than the radius where possible. Cells without it cost EXTRA_COST
# more.
EXTRA_CLEARANCE, EXTRA_COST = 0.03, 3.0
LINE_TOLERANCE = 0.1  # cells: tolerance for dropping points of a path that lie on a line


class PlanOutcome(enum.Enum):
    """Result of a global planner; the value is the message."""

    FOUND = "found"
    CANCELLED = "planning was cancelled"
    START_OFF_MAP = "the robot is off the map"
    GOAL_OFF_MAP = "the goal is off the map"
    START_BLOCKED = "the robot is too close to an obstacle, and there is no free space near it"
    GOAL_IN_OBSTACLE = "the goal is in an obstacle of the map, or closer to one than the robot's radius"
    GOAL_UNKNOWN = "the goal is in an unknown part of the map (see allow_unknown)"
    GOAL_IN_UNMAPPED = "the goal is occupied by an obstacle that is not on the map"
    NO_PATH = "no path leads to the goal on the map"
    BLOCKED = "every path to the goal is blocked by something that is not on the map"

    @property
    def on_map(self) -> bool:
        """Whether the static map alone causes the failure, so that neither waiting nor clearing can help."""
        return self in (
            PlanOutcome.GOAL_OFF_MAP,
            PlanOutcome.GOAL_IN_OBSTACLE,
            PlanOutcome.GOAL_UNKNOWN,
            PlanOutcome.NO_PATH,
        )


class GlobalPlan(NamedTuple):
    """Result of a planner: ``points`` (float64 n, 2; m, in the map frame) of the path, empty unless FOUND.

    ``radius`` (m): clearance of the path except at its ends; 0 for the robot's radius.
    """

    outcome: PlanOutcome
    points: np.ndarray
    radius: float = 0.0

    @property
    def length(self) -> float:
        """Length of the path in m."""
        return float(np.hypot(*np.diff(self.points, axis=0).T).sum()) if len(self.points) > 1 else 0.0


class GridPlannerLimits(NamedTuple):
    """Settings of :class:`GridPlanner`; lengths in m.

    ``comfort_weight``: a path next to a wall costs up to (1 + weight) times one that keeps ``comfort_distance``.
    ``default_tolerance``: maximum distance between an unreachable goal and the end of the path; 0: none, as in navfn.
    ``escape_distance``: maximum distance from the robot to the nearest free space at the start.
    ``spacing``: distance between the points of a path.
    """

    comfort_weight: float = 0.15
    comfort_distance: float = 0.45
    default_tolerance: float = 0.0
    escape_distance: float = 0.5
    spacing: float = 0.25


class GlobalPlanner:
    """Base class of global planner plugins, which ``base_global_planner`` names by class path.

    A planner is created with its parameters: the mapping in the namespace of its class name. All calls come from the
    planning thread, not from the thread that drives the robot. The costmap does not change during a call.

    Another thread sets ``cancelled`` (bool, one item) when the plan is no longer needed. A planner that takes long
    checks :meth:`is_cancelled` regularly and returns the outcome CANCELLED.
    """

    def __init__(self, parameters: Optional[dict] = None) -> None:
        self.parameters = dict(parameters or {})
        self.cancelled = np.zeros(1, dtype=bool)

    def is_cancelled(self) -> bool:
        """Return whether the plan is no longer needed."""
        return bool(self.cancelled[0])

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, tolerance: Optional[float] = None) -> GlobalPlan:
        """Return a path, or why there is none. ``tolerance`` (m) overrides default_tolerance."""
        raise NotImplementedError


class GridPlanner(GlobalPlanner):
    """Finds the cheapest path by fast marching on the clearance field, as navfn does.

    Paths keep the robot's radius free, in tight places up to half a cell less.
    """

    def __init__(self, parameters: Optional[dict] = None) -> None:
        super().__init__(parameters)
        self.limits = GridPlannerLimits(**self.parameters)

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, tolerance: Optional[float] = None) -> GlobalPlan:
        """Return the path; see :class:`GlobalPlanner`."""
        reach = self.limits.default_tolerance if tolerance is None else max(0.0, tolerance)
        found = self._plan(costmap, start, goal, reach)
        if found.outcome is not PlanOutcome.NO_PATH or not costmap.has_marks:
            return found
        # Distinguish obstacles of the laser from those of the map: is there a path on the static map?
        static = self._plan(costmap.static(), start, goal, reach)
        return _failed(PlanOutcome.BLOCKED if static.outcome is PlanOutcome.FOUND else static.outcome)

    def _plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, reach: float) -> GlobalPlan:
        for space in costmap.free_spaces:
            found = self._plan_on(costmap, space, start, goal, reach)
            if found.outcome is PlanOutcome.FOUND:
                break
        return found

    def _plan_on(self, costmap: Costmap, space: FreeSpace, start: Pose2D, goal: Pose2D, reach: float) -> GlobalPlan:
        if not costmap.grid.contains(start.x, start.y):
            return _failed(PlanOutcome.START_OFF_MAP)
        if not costmap.grid.contains(goal.x, goal.y):
            return _failed(PlanOutcome.GOAL_OFF_MAP)
        last = _end(costmap, space, goal, reach)
        if last is None:
            return _failed(self._fault_of_goal(costmap, goal, reach))
        first = _end(costmap, space, start, self.limits.escape_distance)
        if first is None:
            return _failed(PlanOutcome.START_BLOCKED)
        found = march(self._costs(costmap, space), *last.cell, *first.cell, self.cancelled)
        if not math.isfinite(found[first.cell]):
            return _failed(PlanOutcome.CANCELLED if self.is_cancelled() else PlanOutcome.NO_PATH)
        way = descend(found, *first.at, *last.at)[:, ::-1] + 0.5
        ease(way, costmap.occupied, space.radius + EXTRA_CLEARANCE / costmap.resolution)
        points = thin(
            np.concatenate([first.points, way, last.points]), self.limits.spacing / costmap.resolution, LINE_TOLERANCE
        )
        metres = points * costmap.resolution + (costmap.grid.origin_x, costmap.grid.origin_y)
        return GlobalPlan(PlanOutcome.FOUND, metres, space.radius * costmap.resolution - SPARE)

    def _fault_of_goal(self, costmap: Costmap, goal: Pose2D, reach: float) -> PlanOutcome:
        static = costmap.static()
        if costmap.has_marks and any(_end(static, space, goal, reach) is not None for space in static.free_spaces):
            return PlanOutcome.GOAL_IN_UNMAPPED
        unknown = costmap.grid.cells[costmap.grid.cell(goal.x, goal.y)] < 0
        return PlanOutcome.GOAL_UNKNOWN if unknown else PlanOutcome.GOAL_IN_OBSTACLE

    def _costs(self, costmap: Costmap, space: FreeSpace) -> np.ndarray:
        """Return the cost of each cell (float32) per cell length: at least 1, inf where the robot cannot be."""
        comfort = min(self.limits.comfort_distance + costmap.limits.robot_radius, costmap.limits.inflation_radius)
        comfort, weight = max(1.0, comfort / costmap.resolution), self.limits.comfort_weight
        costs = 1.0 + weight * np.maximum(0.0, 1.0 - costmap.clearance / np.float32(comfort))
        ease = np.float32(EXTRA_CLEARANCE / costmap.resolution + 0.5)
        costs += EXTRA_COST * np.clip((np.float32(space.radius) + ease - costmap.clearance) / ease, 0.0, 1.0)
        return np.where(space.open > 0, costs, np.float32(np.inf))


class _End(NamedTuple):
    """One end of a path: an open ``cell``, and the position ``at`` (row, column) in it; cell centres are integers.

    ``points`` (n, 2; x, y in cells): at most one point beyond that position.
    """

    cell: Tuple[int, int]
    at: Tuple[float, float]
    points: np.ndarray


def _end(costmap: Costmap, space: FreeSpace, pose: Pose2D, reach: float) -> Optional[_End]:
    """Return how a pose connects to the open cells: by a straight line, else by an open cell within ``reach`` m."""
    x, y = costmap.to_cells(pose.x, pose.y)
    row, column = costmap.grid.cell(pose.x, pose.y)
    bare = costmap.limits.robot_radius / costmap.resolution
    if square_distance(costmap.occupied, x, y, bare + 1.0) >= bare:
        if space.open[row, column]:
            return _End((row, column), (y - 0.5, x - 0.5), np.empty((0, 2)))
        for cell in _open_cells(space, x, y, JOIN_LIMIT + 1.5 * (space.radius - bare)):
            if least_along(costmap.clearance, x, y, cell[1] + 0.5, cell[0] + 0.5) > 0.0:
                return _End(cell, (float(cell[0]), float(cell[1])), np.array([[x, y]]))
    for cell in _open_cells(space, x, y, reach / costmap.resolution):
        return _End(cell, (float(cell[0]), float(cell[1])), np.empty((0, 2)))
    return None


def _open_cells(space: FreeSpace, x: float, y: float, reach: float) -> Iterator[Tuple[int, int]]:
    """Yield the open cells within ``reach`` of a point (cells), nearest first."""
    top, left = max(0, math.floor(y - reach)), max(0, math.floor(x - reach))
    near = space.open[top : math.ceil(y + reach) + 1, left : math.ceil(x + reach) + 1]
    cells = np.argwhere(near) + np.array([top, left])
    away = np.hypot(cells[:, 0] + 0.5 - y, cells[:, 1] + 0.5 - x)
    for i in np.argsort(away, kind="stable"):
        if away[i] <= reach:
            yield int(cells[i, 0]), int(cells[i, 1])


def _failed(outcome: PlanOutcome) -> GlobalPlan:
    return GlobalPlan(outcome, np.empty((0, 2)))
