"""Plugin interface of local planners, their commands, and radii of the robot's footprint."""

import enum
import math
from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np

from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D


class Velocity(NamedTuple):
    """Speed forward (m/s) and turn (rad/s) of a differential drive."""

    linear: float = 0.0
    angular: float = 0.0


STOP = Velocity()


class FollowOutcome(enum.Enum):
    """Status of a local planner; the value is the message."""

    DRIVING = "driving"
    REACHED = "goal reached"
    BLOCKED = "every movement towards the path would touch an obstacle"
    OFF_PATH = "the robot cannot return to its path in a straight line"


class VelocityCommand(NamedTuple):
    """Result of a local planner. ``at``: the blocked point (m) of the path, which the next plan should avoid."""

    outcome: FollowOutcome
    velocity: Velocity = STOP
    at: Optional[Tuple[float, float]] = None

    def stopping_first(self, before: Velocity) -> "VelocityCommand":
        """Return this command, or a stop while the robot still drives in the opposite direction."""
        turns_round = self.velocity.linear * before.linear < 0.0 and abs(before.linear) > STANDSTILL_SPEED
        return self._replace(velocity=STOP) if turns_round else self


STANDSTILL_SPEED = 0.02  # m/s: maximum speed of a robot that stands still
DISPLAY_TIMES = np.linspace(0.0, 1.0, 8).tolist()  # s: times of the displayed trajectory


class LocalPlanner:
    """Base class of local planner plugins, which ``base_local_planner`` names by class path.

    A planner is created with its parameters, the mapping in the namespace of its class name, and the shape of the
    robot: a radius (m) or a footprint, a sequence of corners (x, y) in m.
    """

    def __init__(self, parameters: Optional[dict] = None, radius: float = 0.18, footprint: Sequence = ()) -> None:
        self.parameters = dict(parameters or {})
        self.radius = radius
        self.footprint = tuple(footprint)

    def set_plan(self, points: np.ndarray, goal: Pose2D) -> None:
        """Set a new path: points (n, 2; m, in the map frame), and the goal pose."""
        raise NotImplementedError

    def compute(self, costmap: Costmap, pose: Pose2D, velocity: Velocity, period: float) -> VelocityCommand:
        """Return the command for the next ``period`` s."""
        raise NotImplementedError

    def length_left(self, pose: Pose2D) -> float:
        """Return the remaining length (m) of the path; infinity without a path."""
        raise NotImplementedError

    def can_turn(self, costmap: Costmap, pose: Pose2D, rate: float) -> bool:
        """Return whether the robot can turn on the spot at ``rate`` rad/s; recovery behaviours check this."""
        return True

    def trajectory(self, pose: Pose2D, velocity: Velocity) -> np.ndarray:
        """Return the predicted points (n, 2; m) of a command, for display."""
        return np.array([pose.advance(*velocity, time)[:2] for time in DISPLAY_TIMES])


def inscribed_radius(radius: float, footprint: Sequence) -> float:
    """Return the radius (m) of the circle around the origin inscribed in the footprint; ``radius`` for a disc."""
    if not len(footprint):
        return radius
    corners = [Pose2D(*corner) for corner in footprint]
    least = math.inf
    for a, b in zip(corners, corners[1:] + corners[:1]):
        length = a.distance(b)
        least = min(least, abs(a.x * b.y - a.y * b.x) / length if length > 0.0 else a.distance(Pose2D(0.0, 0.0)))
    return least


def path_radii(radius: float, footprint: Sequence) -> Tuple[float, ...]:
    """Return the clearances (m) of paths, widest first: to turn anywhere, and only to drive ahead.

    Empty for a disc, whose paths keep its radius.
    """
    if not len(footprint):
        return ()
    turning = max(math.hypot(*corner) for corner in footprint)
    sides = min(max(y for _, y in footprint), max(-y for _, y in footprint))
    return turning, min(turning, max(sides, inscribed_radius(radius, footprint)))
