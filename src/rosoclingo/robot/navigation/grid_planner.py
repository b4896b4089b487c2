"""Global planners: from a start to a goal on a costmap."""

import enum
import math
from typing import Callable, List, NamedTuple, Optional, Tuple

import numpy as np

from rosoclingo.robot.navigation.compiled.places import Ground, nearest_place, places_of
from rosoclingo.robot.navigation.compiled.search import find_cells
from rosoclingo.robot.navigation.compiled.straightening import ease, pull, straighten, tighten
from rosoclingo.robot.navigation.costmap import SPARE, Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.landmarks import CostWeights, Landmarks

__all__ = ["GlobalPlanner", "GridPlanner", "GridPlannerLimits", "Plan", "PlanOutcome"]

STRAIGHT = 5.0  # weight of room on ways that are narrower than the robot's turning circle
PULLS = 1  # of pulling a path straight part by part
# Cells: a way that short is looked for in sixteen directions too, with part of the weight of comfort. In eight, one of
# two ways round may seem up to 8 % longer than it is, which evens out on long ways.
SHORT, PART = 250, 0.5
ROUNDS = 6  # of pulling a path tight
EASE = 0.03  # m more than its radius and SPARE that a way keeps free where it bends, if there is room
JOINED = 3.0  # cells: so near to where a robot can stand, next to a wall or not, is a place of the ways


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


class Plan(NamedTuple):
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
    ``wanted`` tells whether anybody still waits for the plan: a planner that takes long asks it now and then, and
    returns the outcome GIVEN_UP where nobody does.
    """

    def __init__(self, parameters: Optional[dict] = None) -> None:
        self.parameters = dict(parameters or {})
        self.wanted: Callable[[], bool] = lambda: True

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, tolerance: Optional[float] = None) -> Plan:
        """Return a path, or why there is none. ``tolerance`` (m) is default_tolerance unless given."""
        raise NotImplementedError

    def prepare(self, costmap: Costmap) -> bool:
        """Do some of what makes later plans faster, and be brief; tell whether more is left to do.

        It is called again and again while nothing is driven, until it tells that nothing is left for this map.
        """
        return False


class GridPlanner(GlobalPlanner):
    """Cheapest path by A* on the clearance field, straightened: never closer to anything than the robot's radius."""

    def __init__(self, parameters: Optional[dict] = None) -> None:
        super().__init__(parameters)
        self.limits = GridPlannerLimits(**self.parameters)
        self._landmarks: Optional[Landmarks] = None

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, tolerance: Optional[float] = None) -> Plan:
        """Return the path; see :class:`GlobalPlanner`."""
        for i in range(len(costmap.grounds)):
            found = self._plan_on(costmap, (costmap.grounds[i], costmap.static_grounds[i]), start, goal, tolerance)
            if found.outcome is PlanOutcome.FOUND:
                return found
        if found.outcome is not PlanOutcome.NO_PATH or not costmap.has_marks:
            return found
        # Whom to blame: is there a way on the map alone?
        alone = self._plan_on(costmap, (costmap.static_grounds[-1],) * 2, start, goal, tolerance)
        return _failed(PlanOutcome.BLOCKED if alone.outcome is PlanOutcome.FOUND else alone.outcome)

    def _plan_on(
        self, costmap: Costmap, grounds: Tuple[Ground, Ground], start: Pose2D, goal: Pose2D, tolerance: Optional[float]
    ) -> Plan:
        """Plan on one ground; the other one is that of the map alone."""
        ground, static_ground = grounds
        if not costmap.grid.contains(start.x, start.y):
            return _failed(PlanOutcome.START_OFF_MAP)
        if not costmap.grid.contains(goal.x, goal.y):
            return _failed(PlanOutcome.GOAL_OFF_MAP)
        reach = self.limits.default_tolerance if tolerance is None else max(0.0, tolerance)
        last = _end(costmap, ground, goal, reach)
        if last is None:
            if _end(costmap, static_ground, goal, reach) is not None:
                return _failed(PlanOutcome.GOAL_IN_UNMAPPED)
            unknown = costmap.grid.cells[costmap.grid.cell(goal.x, goal.y)] < 0
            return _failed(PlanOutcome.GOAL_UNKNOWN if unknown else PlanOutcome.GOAL_IN_OBSTACLE)
        first = _end(costmap, ground, start, self.limits.escape_distance)
        if first is None:
            return _failed(PlanOutcome.START_BLOCKED)
        weights = self._weights(costmap)
        narrow = ground.radius < costmap.grounds[0].radius
        if narrow:
            # Where it cannot turn the robot is to get straight in and straight out.
            weights = CostWeights(costmap.grounds[0].radius, STRAIGHT)
        landmarks = self._costs_of_landmarks(costmap, weights)
        cells = find_cells(ground, *weights, *first.cell, *last.cell, 8, landmarks, self.wanted)
        if cells is not None and 0 < len(cells) < SHORT and not narrow:
            fine = weights._replace(weight=PART * weights.weight)
            cells = find_cells(ground, *fine, *first.cell, *last.cell, 16, landmarks[:0], self.wanted)
        if cells is None or not len(cells):
            return _failed(PlanOutcome.GIVEN_UP if cells is None else PlanOutcome.NO_PATH)
        points = np.concatenate([first.points, places_of(ground.places, cells), last.points])
        pull(points, ground, *weights, PULLS)
        points = straighten(points, ground, *weights)
        tighten(points, ground, *weights, ROUNDS)
        points = straighten(points, ground, *weights)
        ease(points, ground, EASE / costmap.resolution)
        return Plan(PlanOutcome.FOUND, self._in_metres(costmap, points), ground.radius * costmap.resolution - SPARE)

    def prepare(self, costmap: Costmap) -> bool:
        """Find landmarks on the map, part by part; see :class:`GlobalPlanner`."""
        if self._landmarks is None or self._landmarks.ground is not costmap.static_grounds[-1]:
            self._landmarks = Landmarks(costmap.static_grounds[-1], self._weights(costmap))
        self._landmarks.go_on()
        return not self._landmarks.done

    def _costs_of_landmarks(self, costmap: Costmap, weights: CostWeights) -> np.ndarray:
        """Return what the search is led by (float32; n, cells), n 0 where nothing has been prepared for this map."""
        found = self._landmarks
        if found is None or found.ground is not costmap.static_grounds[-1] or found.weights != weights:
            return np.empty((0, costmap.grounds[-1].places.size), dtype=np.float32)
        return found.costs

    def _weights(self, costmap: Costmap) -> CostWeights:
        comfort = min(self.limits.comfort_distance + costmap.limits.robot_radius, costmap.limits.inflation_radius)
        return CostWeights(max(1.0, comfort / costmap.resolution), self.limits.comfort_weight)

    def _in_metres(self, costmap: Costmap, points: np.ndarray) -> np.ndarray:
        """Return the points in m, with more of them put in at ``spacing``."""
        metres = points * costmap.resolution + (costmap.grid.origin_x, costmap.grid.origin_y)
        return dense(metres, self.limits.spacing)


class _End(NamedTuple):
    """Where a way begins or ends: a ``cell`` with a place, and its ``points`` (n, 2) beyond that: one or none."""

    cell: Tuple[int, int]
    points: np.ndarray


def _end(costmap: Costmap, ground: Ground, pose: Pose2D, reach: float) -> Optional[_End]:
    """Return how a pose is joined to the ways: by a straight line, else by the nearest place within ``reach`` m."""
    x, y = costmap.to_cells(pose.x, pose.y)
    bare = ground._replace(radius=costmap.limits.robot_radius / costmap.resolution)
    row, column = nearest_place(bare, x, y, JOINED + 1.5 * (ground.radius - bare.radius), True)
    if row >= 0:
        return _End((row, column), np.array([[x, y]]))
    row, column = nearest_place(ground, x, y, reach / costmap.resolution, False)
    return _End((row, column), np.empty((0, 2))) if row >= 0 else None


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
