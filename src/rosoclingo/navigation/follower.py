"""Local planners: from a path and what is near to the next velocity."""

import enum
import math
from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np

from rosoclingo.navigation.costmap import Costmap
from rosoclingo.navigation.geometry import Pose2D, normalize_angle
from rosoclingo.navigation.rollout import best_command, body_clearance, least_along, spare_after

__all__ = [
    "Command",
    "FollowOutcome",
    "FollowerLimits",
    "LocalPlanner",
    "RolloutFollower",
    "Velocity",
    "body_discs",
    "inscribed_radius",
]


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


class Command(NamedTuple):
    """What a local planner answers."""

    outcome: FollowOutcome
    velocity: Velocity = STOP


class FollowerLimits(NamedTuple):
    """Settings of :class:`RolloutFollower`, named as move_base's local planners name theirs (m, rad, s)."""

    max_vel_x: float = 0.65
    max_vel_theta: float = 1.2
    creep_vel_x: float = 0.15
    acc_lim_x: float = 1.0
    acc_lim_theta: float = 3.2
    xy_goal_tolerance: float = 0.1
    yaw_goal_tolerance: float = 0.1
    sim_time: float = 1.2
    vx_samples: int = 7
    vtheta_samples: int = 21
    lookahead: float = 0.7
    margin: float = 0.02
    comfort: float = 0.15
    turn_gain: float = 1.8


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

    def compute(self, costmap: Costmap, pose: Pose2D, velocity: Velocity, period: float) -> Command:
        """Return the command for the next ``period`` s."""
        raise NotImplementedError

    def trajectory(self, pose: Pose2D, velocity: Velocity) -> np.ndarray:
        """Return the points (n, 2; m) that a command leads through, for display."""
        times = np.linspace(0.0, 1.0, 8)
        return np.array([pose.moved(velocity.linear, velocity.angular, t)[:2] for t in times])


def body_discs(radius: float, footprint: Sequence, resolution: float) -> np.ndarray:
    """Return the discs (float64 n, 3; cells) that stand for the robot: one, or many along the footprint's edge."""
    if not len(footprint):
        return np.array([[0.0, 0.0, radius]]) / resolution
    corners = [np.array(corner, dtype=np.float64) for corner in footprint]
    discs = []
    for a, b in zip(corners, corners[1:] + corners[:1]):
        count = max(1, int(math.ceil(math.hypot(*(b - a)) / resolution)))
        for i in range(count):
            discs.append((*(a + (b - a) * (i / count)), 0.25 * resolution))
    return np.array(discs) / resolution


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


class RolloutFollower(LocalPlanner):
    """Tries commands on the clearance field and takes the safe one that leads best to a point ahead on the path."""

    def __init__(self, parameters: Optional[dict] = None, radius: float = 0.18, footprint: Sequence = ()) -> None:
        super().__init__(parameters, radius, footprint)
        self.limits = FollowerLimits(**self.parameters)
        self._points = np.empty((0, 2))
        self._goal = Pose2D(0.0, 0.0)
        self._index = 0
        self._arrived = False
        self._refuge: Optional[np.ndarray] = None
        self._patience = 10.0
        self._inner = inscribed_radius(radius, footprint)
        self._body: Tuple[float, np.ndarray] = (0.0, np.empty((0, 3)))

    def set_plan(self, points: np.ndarray, goal: Pose2D) -> None:
        """Take a new path; see :class:`LocalPlanner`."""
        if goal != self._goal:
            self._arrived, self._refuge, self._patience = False, None, 10.0
        self._points, self._goal, self._index = points, goal, 0

    def compute(self, costmap: Costmap, pose: Pose2D, velocity: Velocity, period: float) -> Command:
        """Return the next command; see :class:`LocalPlanner`."""
        if not len(self._points):
            return Command(FollowOutcome.OFF_PATH)
        end = self._points[-1]
        distance = math.hypot(end[0] - pose.x, end[1] - pose.y)
        # Once there the robot only turns: what it drifts while turning must not send it off again (twice is leaving).
        self._arrived = distance <= self.limits.xy_goal_tolerance * (2.0 if self._arrived else 1.0)
        if self._arrived:
            return self._turn(costmap, pose, velocity, normalize_angle(self._goal.yaw - pose.yaw), final=True)
        carrots = self._carrots(costmap, pose)
        if not len(carrots):
            return Command(FollowOutcome.OFF_PATH)
        if self._refuge is None:
            command = self._towards(costmap, pose, velocity, carrots[0], distance, period)
            if command.outcome is not FollowOutcome.BLOCKED:
                return command
            # Too tight for a straight try: first to the path itself, which is clear, then on along it.
            self._refuge = carrots[-1]
        return self._take_refuge(costmap, pose, velocity, period)

    def _take_refuge(self, costmap: Costmap, pose: Pose2D, velocity: Velocity, period: float) -> Command:
        """Creep to the nearest point of the path."""
        x, y = self._refuge
        distance = math.hypot(x - pose.x, y - pose.y)
        self._patience -= period
        if distance < 0.25 * costmap.resolution or self._patience <= 0.0:
            self._refuge, self._patience = None, 10.0
            return Command(FollowOutcome.BLOCKED)
        return self._towards(costmap, pose, velocity, self._refuge, distance, period)

    def _towards(self, costmap, pose, velocity, carrot, distance, period) -> Command:  # type: ignore[no-untyped-def]
        """Drive to a point, turning to it first where it is not ahead."""
        bearing = normalize_angle(math.atan2(carrot[1] - pose.y, carrot[0] - pose.x) - pose.yaw)
        near = math.hypot(carrot[0] - pose.x, carrot[1] - pose.y) < 0.15
        if abs(bearing) > (0.15 if near else 1.2) and velocity.linear < 0.1:
            return self._turn(costmap, pose, velocity, bearing, final=False)
        command = self._drive(costmap, pose, velocity, carrot, distance, period)
        if command.outcome is FollowOutcome.BLOCKED and abs(bearing) > 0.1:
            return self._turn(costmap, pose, velocity, bearing, final=False)
        return command

    def _body_for(self, resolution: float) -> np.ndarray:
        if self._body[0] != resolution:
            self._body = (resolution, body_discs(self.radius, self.footprint, resolution))
        return self._body[1]

    def _carrots(self, costmap: Costmap, pose: Pose2D) -> np.ndarray:
        """Return points (n, 2) ahead on the path that a straight line leads to, the furthest first."""
        self._advance(pose)
        here = costmap.to_cells(pose.x, pose.y)
        points = self._ahead(pose)[::-1]
        spare = np.array([least_along(costmap.clearance, *here, *costmap.to_cells(*point)) for point in points])
        # Only a direction: what is driven is tried for safety. Where the robot stands too close, anything free will do.
        for least in (self._inner / costmap.resolution - 0.25, 0.0):
            if (spare >= least).any():
                return points[spare >= least]
        return points[:0]

    def _advance(self, pose: Pose2D) -> None:
        """Move on to the path's point nearest to the robot; never back."""
        window = self._points[self._index : self._index + 12]
        away = np.hypot(window[:, 0] - pose.x, window[:, 1] - pose.y)
        self._index += int(away.argmin())

    def _ahead(self, pose: Pose2D) -> np.ndarray:
        """Return points of the path from the robot on, up to the look-ahead."""
        points = self._points[self._index : self._index + 2 + int(4 * self.limits.lookahead / 0.25)]
        steps = np.hypot(*np.diff(points, axis=0).T) if len(points) > 1 else np.empty(0)
        along = np.concatenate(([0.0], np.cumsum(steps)))
        reach = np.linspace(0.0, min(self.limits.lookahead, along[-1]), 7)
        return np.stack([np.interp(reach, along, points[:, axis]) for axis in (0, 1)], axis=1)

    def _drive(self, costmap, pose, velocity, carrot, distance, period) -> Command:  # type: ignore[no-untyped-def]
        """Try commands that keep the margin; where there is none, slow ones that barely touch nothing."""
        for margin, top in ((self.limits.margin, self.limits.max_vel_x), (0.0, self.limits.creep_vel_x)):
            found = self._best(costmap, pose, velocity, carrot, distance, period, margin, top)
            if found.linear >= 0.01 or abs(found.angular) >= 0.05:
                return Command(FollowOutcome.DRIVING, found)
        return Command(FollowOutcome.BLOCKED)

    def _best(self, costmap, pose, velocity, carrot, distance, period, margin, top) -> Velocity:  # type: ignore[no-untyped-def]
        """Return the best of the speeds and turns within reach of the accelerations, a stop where none is safe."""
        limits, scale = self.limits, 1.0 / costmap.resolution
        top = min(top, math.sqrt(limits.acc_lim_x * max(distance, 0.01)))
        high = min(top, velocity.linear + limits.acc_lim_x * period)
        low = max(0.0, min(high, velocity.linear - limits.acc_lim_x * period))
        speeds = np.concatenate((np.linspace(high, low, limits.vx_samples), [0.0]))
        reach = limits.acc_lim_theta * period
        turns = np.linspace(
            max(-limits.max_vel_theta, velocity.angular - reach),
            min(limits.max_vel_theta, velocity.angular + reach),
            limits.vtheta_samples,
        )
        turns = np.concatenate((turns, [0.0]))
        place = np.array([*costmap.to_cells(pose.x, pose.y), pose.yaw])
        weights = np.array([costmap.resolution, 0.25, 0.6 * costmap.resolution])
        i, j, _ = best_command(
            costmap.clearance, costmap.occupied, self._body_for(costmap.resolution), place, speeds * scale, turns,
            np.array(costmap.to_cells(*carrot)), margin * scale, limits.comfort * scale,
            self._horizon(distance), 12, weights,
        )  # fmt: skip
        return Velocity(float(speeds[i]), float(turns[j])) if i >= 0 else STOP

    def _horizon(self, distance: float) -> float:
        """Return how far ahead (s) to look: less when the goal is near, so that the arc does not end beyond it."""
        return max(0.6, min(self.limits.sim_time, 2.0 * distance / self.limits.max_vel_x))

    def _turn(self, costmap, pose, velocity, error, final) -> Command:  # type: ignore[no-untyped-def]
        """Turn on the spot by ``error`` rad; ``final``: that is all that is left to do."""
        if velocity.linear > 0.05:
            return Command(FollowOutcome.DRIVING)
        if final and abs(error) <= self.limits.yaw_goal_tolerance:
            done = abs(velocity.angular) < 0.2 or abs(error) < 0.25 * self.limits.yaw_goal_tolerance
            return Command(FollowOutcome.REACHED if done else FollowOutcome.DRIVING)
        rate = math.copysign(min(self.limits.max_vel_theta, self.limits.turn_gain * abs(error) + 0.03), error)
        if not self.may_turn(costmap, pose, rate):
            return Command(FollowOutcome.BLOCKED)
        return Command(FollowOutcome.DRIVING, Velocity(0.0, rate))

    def may_turn(self, costmap: Costmap, pose: Pose2D, rate: float) -> bool:
        """Tell whether turning on the spot at ``rate`` rad/s touches nothing that the robot does not touch now."""
        if not len(self.footprint):
            return True
        body, (x, y) = self._body_for(costmap.resolution), costmap.to_cells(pose.x, pose.y)
        now = body_clearance(costmap.clearance, costmap.occupied, body, x, y, pose.yaw)
        spare = spare_after(costmap.clearance, costmap.occupied, body, x, y, pose.yaw, 0.0, rate, 0.4, 4)[0]
        return bool(spare >= min(0.0, now - 1e-3))
