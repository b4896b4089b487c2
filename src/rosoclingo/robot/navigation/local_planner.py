"""What every local planner has: the plugin interface, commands, the robot's body."""

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
    """What a local planner has to say besides its command."""

    DRIVING = "driving"
    REACHED = "goal reached"
    BLOCKED = "every movement towards the path would touch an obstacle"
    OFF_PATH = "the robot cannot get back to its path in a straight line"


class VelocityCommand(NamedTuple):
    """The answer of a local planner; ``at``: a point (m) of the path that is blocked, to be avoided."""

    outcome: FollowOutcome
    velocity: Velocity = STOP
    at: Optional[Tuple[float, float]] = None

    def stopping_first(self, before: Velocity) -> "VelocityCommand":
        """Return this, or a stop while the robot still drives the other way: no turn is to begin before."""
        turns_round = self.velocity.linear * before.linear < 0.0 and abs(before.linear) > STILL
        return self._replace(velocity=STOP) if turns_round else self


STILL = 0.02  # m/s
SHOWN = np.linspace(0.0, 1.0, 8).tolist()  # s ahead


class LocalPlanner:
    """What a local planner plugin does: subclasses are named by class path in ``base_local_planner``.

    It is made with its parameters (the mapping under the last part of its class path) and the robot's footprint, a
    sequence of (x, y) in m, or a radius in m.
    """

    def __init__(self, parameters: Optional[dict] = None, radius: float = 0.18, footprint: Sequence = ()) -> None:
        self.parameters = dict(parameters or {})
        self.radius = radius
        self.footprint = tuple(footprint)

    def set_plan(self, points: np.ndarray, goal: Pose2D) -> None:
        """Take a new path: points (n, 2) in m in the map's frame, and the pose to end in."""
        raise NotImplementedError

    def compute(self, costmap: Costmap, pose: Pose2D, velocity: Velocity, period: float) -> VelocityCommand:
        """Return the command for the next ``period`` s."""
        raise NotImplementedError

    def length_left(self, pose: Pose2D) -> float:
        """Return the length (m) of the path that is still to be driven; infinity without a path."""
        raise NotImplementedError

    def may_turn(self, costmap: Costmap, pose: Pose2D, rate: float) -> bool:
        """Return whether turning on the spot at ``rate`` rad/s touches nothing; a recovery asks before it turns."""
        return True

    def trajectory(self, pose: Pose2D, velocity: Velocity) -> np.ndarray:
        """Return the points (n, 2; m) that a command leads through, for display."""
        return np.array([pose.moved(*velocity, time)[:2] for time in SHOWN])


def inscribed_radius(radius: float, footprint: Sequence) -> float:
    """Return the radius (m) of the largest disc around the robot's origin within its footprint; else ``radius``."""
    if not len(footprint):
        return radius
    corners = [Pose2D(*corner) for corner in footprint]
    least = math.inf
    for a, b in zip(corners, corners[1:] + corners[:1]):
        length = a.distance(b)
        least = min(least, abs(a.x * b.y - a.y * b.x) / length if length > 0.0 else a.distance(Pose2D(0.0, 0.0)))
    return least


def way_radii(radius: float, footprint: Sequence) -> Tuple[float, ...]:
    """Return the radii (m) that ways keep free, widest first: where the robot can turn, where it can drive ahead.

    None for a disc, whose ways keep its radius.
    """
    if not len(footprint):
        return ()
    turning = max(math.hypot(*corner) for corner in footprint)
    sides = min(max(y for _, y in footprint), max(-y for _, y in footprint))
    return turning, min(turning, max(sides, inscribed_radius(radius, footprint)))
