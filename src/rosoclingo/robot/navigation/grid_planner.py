"""Global planners: from a start to a goal on a costmap."""

import enum
import math
from typing import Iterator, NamedTuple, Optional, Tuple

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import square_distance
from rosoclingo.robot.navigation.compiled.marching import ease, march, thin, way_down
from rosoclingo.robot.navigation.compiled.path import least_along
from rosoclingo.robot.navigation.costmap import SPARE, Costmap, Ground
from rosoclingo.robot.navigation.geometry import Pose2D

STRAIGHT = 5.0  # weight of room on ways that are narrower than the robot's turning circle
JOINED = 3.0  # cells: so near to where a robot can stand, next to a wall or not, is an open cell
# A way keeps so much (m) more than its radius free, and half a cell, where it can: else it costs DEAR more.
EASE, DEAR = 0.03, 3.0
BENT = 0.1  # cells: points of a path are left out where it is straighter than that


class PlanOutcome(enum.Enum):
    """Why a planner answers as it does."""

    FOUND = "found"
    GIVEN_UP = "planning was given up, as nobody waits for it any more"
    START_OFF_MAP = "the robot is outside of the map"
    GOAL_OFF_MAP = "the goal is outside of the map"
    START_BLOCKED = "the robot is too close to an obstacle, and nowhere near it can it stand"
    GOAL_IN_OBSTACLE = "the goal is in an obstacle of the map, or closer to one than the robot's radius"
    GOAL_UNKNOWN = "the goal is where the map does not know what is there (see allow_unknown)"
    GOAL_IN_UNMAPPED = "the goal is taken: something that is not on the map stands there"
    NO_PATH = "no path leads to the goal on the map"
    BLOCKED = "every path to the goal is blocked by something that is not on the map"

    @property
    def on_map(self) -> bool:
        """Whether the map alone is the reason, so that waiting or clearing cannot help."""
        return self in (
            PlanOutcome.GOAL_OFF_MAP,
            PlanOutcome.GOAL_IN_OBSTACLE,
            PlanOutcome.GOAL_UNKNOWN,
            PlanOutcome.NO_PATH,
        )


class GlobalPlan(NamedTuple):
    """What a planner found: ``points`` (float64 n, 2; x, y in m in the map's frame), empty unless FOUND.

    ``radius`` (m): what the way keeps free, but at its ends; 0 for the robot's own.
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
    ``default_tolerance``: how far from a goal that cannot be reached the path may end, 0: not at all (as navfn).
    ``escape_distance``: how far the robot may be from a place with clearance and still set off.
    ``spacing``: distance between the points of a path.
    """

    comfort_weight: float = 0.15
    comfort_distance: float = 0.45
    default_tolerance: float = 0.0
    escape_distance: float = 0.5
    spacing: float = 0.25


class GlobalPlanner:
    """What a global planner plugin does: subclasses are named by class path in ``base_global_planner``.

    It is made with its parameters, the mapping under the last part of its class path. All calls come from one thread,
    beside that which drives the robot; the costmap does not change meanwhile.
    ``dropped`` (bool, one item) is set by another thread when nobody waits for the plan any more: a planner that takes
    long asks :meth:`wanted` now and then, and returns the outcome GIVEN_UP.
    """

    def __init__(self, parameters: Optional[dict] = None) -> None:
        self.parameters = dict(parameters or {})
        self.dropped = np.zeros(1, dtype=bool)

    def wanted(self) -> bool:
        """Return whether anybody still waits for the plan."""
        return not self.dropped[0]

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, tolerance: Optional[float] = None) -> GlobalPlan:
        """Return a path, or why there is none. ``tolerance`` (m) is default_tolerance unless given."""
        raise NotImplementedError


class GridPlanner(GlobalPlanner):
    """Cheapest path by fast marching on the clearance field, as navfn: no closer to anything than the robot's radius.

    In tight places half a cell closer.
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
        # Whom to blame: is there a way on the map alone?
        alone = self._plan(costmap.alone(), start, goal, reach)
        return _failed(PlanOutcome.BLOCKED if alone.outcome is PlanOutcome.FOUND else alone.outcome)

    def _plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, reach: float) -> GlobalPlan:
        for ground in costmap.grounds:
            found = self._plan_on(costmap, ground, start, goal, reach)
            if found.outcome is PlanOutcome.FOUND:
                break
        return found

    def _plan_on(self, costmap: Costmap, ground: Ground, start: Pose2D, goal: Pose2D, reach: float) -> GlobalPlan:
        if not costmap.grid.contains(start.x, start.y):
            return _failed(PlanOutcome.START_OFF_MAP)
        if not costmap.grid.contains(goal.x, goal.y):
            return _failed(PlanOutcome.GOAL_OFF_MAP)
        last = _end(costmap, ground, goal, reach)
        if last is None:
            return _failed(self._fault_of_goal(costmap, goal, reach))
        first = _end(costmap, ground, start, self.limits.escape_distance)
        if first is None:
            return _failed(PlanOutcome.START_BLOCKED)
        found = march(self._costs(costmap, ground), *last.cell, *first.cell, self.dropped)
        if not math.isfinite(found[first.cell]):
            return _failed(PlanOutcome.NO_PATH if self.wanted() else PlanOutcome.GIVEN_UP)
        way = way_down(found, *first.at, *last.at)[:, ::-1] + 0.5
        ease(way, costmap.occupied, ground.radius + EASE / costmap.resolution)
        points = thin(np.concatenate([first.points, way, last.points]), self.limits.spacing / costmap.resolution, BENT)
        metres = points * costmap.resolution + (costmap.grid.origin_x, costmap.grid.origin_y)
        return GlobalPlan(PlanOutcome.FOUND, metres, ground.radius * costmap.resolution - SPARE)

    def _fault_of_goal(self, costmap: Costmap, goal: Pose2D, reach: float) -> PlanOutcome:
        alone = costmap.alone()
        if costmap.has_marks and any(_end(alone, ground, goal, reach) is not None for ground in alone.grounds):
            return PlanOutcome.GOAL_IN_UNMAPPED
        unknown = costmap.grid.cells[costmap.grid.cell(goal.x, goal.y)] < 0
        return PlanOutcome.GOAL_UNKNOWN if unknown else PlanOutcome.GOAL_IN_OBSTACLE

    def _costs(self, costmap: Costmap, ground: Ground) -> np.ndarray:
        """Return what a way of the length of a cell costs in each (float32): 1, and more next to things."""
        comfort = min(self.limits.comfort_distance + costmap.limits.robot_radius, costmap.limits.inflation_radius)
        comfort, weight = max(1.0, comfort / costmap.resolution), self.limits.comfort_weight
        if ground.radius < costmap.grounds[0].radius:
            # Where it cannot turn the robot is to get straight in and straight out.
            comfort, weight = costmap.grounds[0].radius, STRAIGHT
        costs = 1.0 + weight * np.maximum(0.0, 1.0 - costmap.clearance / np.float32(comfort))
        ease = np.float32(EASE / costmap.resolution + 0.5)
        costs += DEAR * np.clip((np.float32(ground.radius) + ease - costmap.clearance) / ease, 0.0, 1.0)
        return np.where(ground.open > 0, costs, np.float32(np.inf))


class _End(NamedTuple):
    """Where a way begins or ends: ``at`` (row, column; 0 in the middle of the first) in an open ``cell``.

    ``points`` (n, 2; x, y in cells) are those beyond that: one or none.
    """

    cell: Tuple[int, int]
    at: Tuple[float, float]
    points: np.ndarray


def _end(costmap: Costmap, ground: Ground, pose: Pose2D, reach: float) -> Optional[_End]:
    """Return how a pose is joined to the ways: by a straight line, else by the nearest open cell within ``reach`` m."""
    x, y = costmap.to_cells(pose.x, pose.y)
    row, column = costmap.grid.cell(pose.x, pose.y)
    bare = costmap.limits.robot_radius / costmap.resolution
    if square_distance(costmap.occupied, x, y, bare + 1.0) >= bare:
        if ground.open[row, column]:
            return _End((row, column), (y - 0.5, x - 0.5), np.empty((0, 2)))
        for cell in _open_cells(ground, x, y, JOINED + 1.5 * (ground.radius - bare)):
            if least_along(costmap.clearance, x, y, cell[1] + 0.5, cell[0] + 0.5) > 0.0:
                return _End(cell, (float(cell[0]), float(cell[1])), np.array([[x, y]]))
    for cell in _open_cells(ground, x, y, reach / costmap.resolution):
        return _End(cell, (float(cell[0]), float(cell[1])), np.empty((0, 2)))
    return None


def _open_cells(ground: Ground, x: float, y: float, reach: float) -> Iterator[Tuple[int, int]]:
    """Yield the open cells whose middle is within ``reach`` of a point (cells), the nearest first."""
    top, left = max(0, math.floor(y - reach)), max(0, math.floor(x - reach))
    near = ground.open[top : math.ceil(y + reach) + 1, left : math.ceil(x + reach) + 1]
    cells = np.argwhere(near) + np.array([top, left])
    away = np.hypot(cells[:, 0] + 0.5 - y, cells[:, 1] + 0.5 - x)
    for i in np.argsort(away, kind="stable"):
        if away[i] <= reach:
            yield int(cells[i, 0]), int(cells[i, 1])


def _failed(outcome: PlanOutcome) -> GlobalPlan:
    return GlobalPlan(outcome, np.empty((0, 2)))
