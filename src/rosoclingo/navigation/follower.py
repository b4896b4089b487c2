"""The local planner: from a path and what is near to the next velocity."""

import math
from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np

from rosoclingo.navigation.compiled_rollout import (
    best_command,
    body_clearance,
    furthest_clear,
    nearest_index,
    points_at,
    spare_after,
)
from rosoclingo.navigation.costmap import Costmap
from rosoclingo.navigation.geometry import Pose2D, normalize_angle
from rosoclingo.navigation.local_planner import (
    STOP,
    Command,
    FollowOutcome,
    LocalPlanner,
    Velocity,
    body_discs,
    inscribed_radius,
)

__all__ = ["FollowerLimits", "RolloutFollower"]

# A point that close (m) is turned to before it is driven to; beyond BEHIND (rad) any point is.
NEAR, ASIDE, BEHIND, FACING = 0.15, 0.15, 1.2, 0.3
CLOSE = 0.005  # m that are kept free even where it is tight, unless there are less already
STEPS = 12  # places looked at along a trial
PATIENCE = 10.0  # s that a robot takes to get out of a tight place before it says so


class FollowerLimits(NamedTuple):
    """Settings of :class:`RolloutFollower`, named as move_base's local planners name theirs (m, rad, s).

    Its own: ``lookahead``, how far ahead on the path it aims; ``margin``, what it keeps free beside the robot where
    there is room, at ``creep_vel_x`` and slower where there is not; ``comfort``, up to where more room counts as
    better; ``turn_gain`` (1/s), by which it turns slower towards the end of a turn.
    """

    max_vel_x: float = 0.65
    max_vel_theta: float = 1.2
    acc_lim_x: float = 1.0
    acc_lim_theta: float = 3.2
    xy_goal_tolerance: float = 0.1
    yaw_goal_tolerance: float = 0.1
    sim_time: float = 1.2
    vx_samples: int = 7
    vtheta_samples: int = 21
    lookahead: float = 0.7
    margin: float = 0.02
    creep_vel_x: float = 0.15
    comfort: float = 0.15
    turn_gain: float = 1.8


class Situation(NamedTuple):
    """What a command is found for: the map, the robot's pose and velocity, and for how long (s)."""

    costmap: Costmap
    pose: Pose2D
    velocity: Velocity
    period: float

    def bearing(self, point: Sequence[float]) -> float:
        """Return the angle (rad) by which the robot would have to turn to face a point."""
        return normalize_angle(math.atan2(point[1] - self.pose.y, point[0] - self.pose.x) - self.pose.yaw)

    def distance(self, point: Sequence[float]) -> float:
        """Return the distance (m) to a point."""
        return math.hypot(point[0] - self.pose.x, point[1] - self.pose.y)


class Trial(NamedTuple):
    """Which commands to try: speeds (m/s), the room (m) to keep, and the weights of :func:`best_command`."""

    speeds: np.ndarray
    margin: float
    comfort: float
    weights: Tuple[float, float, float]


class RolloutFollower(LocalPlanner):
    """Tries commands on the clearance field and takes the safe one that leads best to a point ahead on the path."""

    def __init__(self, parameters: Optional[dict] = None, radius: float = 0.18, footprint: Sequence = ()) -> None:
        super().__init__(parameters, radius, footprint)
        self.limits = FollowerLimits(**self.parameters)
        self._points, self._along = np.empty((0, 2)), np.empty(0)
        self._ahead = np.linspace(0.0, self.limits.lookahead, 7)
        self._turns = np.linspace(-1.0, 1.0, self.limits.vtheta_samples)
        self._slower = np.append(np.linspace(1.0, 0.0, self.limits.vx_samples), 0.0)
        self._goal = Pose2D(0.0, 0.0)
        self._index = 0
        self._arrived = False
        self._refuge: Optional[Tuple[float, float]] = None
        self._patience = PATIENCE
        self._inner = inscribed_radius(radius, footprint)
        self._body: Tuple[float, np.ndarray] = (0.0, np.empty((0, 3)))

    def set_plan(self, points: np.ndarray, goal: Pose2D) -> None:
        """Take a new path; see :class:`LocalPlanner`."""
        if goal != self._goal:
            self._arrived, self._refuge, self._patience = False, None, PATIENCE
        self._points, self._goal, self._index = np.ascontiguousarray(points, dtype=np.float64), goal, 0
        steps = np.hypot(*np.diff(self._points, axis=0).T) if len(points) > 1 else np.empty(0)
        self._along = np.concatenate(([0.0], np.cumsum(steps)))

    def compute(self, costmap: Costmap, pose: Pose2D, velocity: Velocity, period: float) -> Command:
        """Return the next command; see :class:`LocalPlanner`."""
        if not len(self._points):
            return Command(FollowOutcome.OFF_PATH)
        now = Situation(costmap, pose, velocity, period)
        # Once there the robot only turns: what it drifts while turning must not send it off again (twice is leaving).
        tolerance = self.limits.xy_goal_tolerance * (2.0 if self._arrived else 1.0)
        self._arrived = now.distance(self._points[-1]) <= tolerance
        if self._arrived:
            return self._turn(now, normalize_angle(self._goal.yaw - pose.yaw), final=True)
        if self._refuge is None:
            carrot = self._carrot(now)
            command = self._towards(now, carrot) if carrot is not None else Command(FollowOutcome.BLOCKED)
            if command.outcome is not FollowOutcome.BLOCKED:
                self._patience = PATIENCE
                return command
            # Too tight for a straight try: first to the path itself, which is clear, then on along it.
            self._refuge = self._refuge_on_path(now)
        return self._take_refuge(now, self._refuge)

    def length_left(self, pose: Pose2D) -> float:
        """Return what is left of the path; see :class:`LocalPlanner`."""
        if not len(self._points):
            return math.inf
        self._advance(pose)
        x, y = self._points[self._index]
        return math.hypot(x - pose.x, y - pose.y) + float(self._along[-1] - self._along[self._index])

    def _refuge_on_path(self, now: Situation) -> Tuple[float, float]:
        """Return the path's point next to the robot or, where the robot is on it, the one a good cell ahead."""
        points = points_at(self._points, self._along, self._index, np.array([0.0, 1.2 * now.costmap.resolution]))
        point = points[0] if now.distance(points[0]) > 0.3 * now.costmap.resolution else points[1]
        return float(point[0]), float(point[1])

    def _take_refuge(self, now: Situation, refuge: Tuple[float, float]) -> Command:
        """Creep to the nearest point of the path; where that is impossible, to where there is more room."""
        self._patience -= now.period
        if now.distance(refuge) < 0.25 * now.costmap.resolution:
            self._refuge = None
        elif self._patience > 0.0:
            command = self._towards(now, refuge)
            if command.outcome is not FollowOutcome.BLOCKED:
                return command
            self._refuge = None
        return self._escape(now, refuge)

    def _escape(self, now: Situation, refuge: Sequence[float]) -> Command:
        """Creep, backwards too, to where there is more room."""
        slow = self.limits.creep_vel_x
        speeds = np.array([slow, 0.5 * slow, -0.5 * slow, -slow])
        found = self._best(now, refuge, Trial(speeds, CLOSE, 2.0 * self.radius, (0.1, 0.0, 1.0)))
        if found is None or self._patience <= 0.0:
            self._refuge, self._patience = None, PATIENCE
            return Command(FollowOutcome.BLOCKED)
        self._patience -= now.period
        return Command(FollowOutcome.DRIVING, found)

    def _towards(self, now: Situation, carrot: Tuple[float, float]) -> Command:
        """Drive to a point, turning to it first where it is not ahead."""
        bearing = now.bearing(carrot)
        aside = abs(bearing) > (ASIDE if now.distance(carrot) < NEAR else BEHIND)
        if aside and now.velocity.linear < 0.1:
            return self._turn(now, bearing)
        command = self._drive(now, carrot)
        if command.outcome is FollowOutcome.BLOCKED and abs(bearing) > 0.1:
            return self._turn(now, bearing)
        return command

    def _drive(self, now: Situation, carrot: Sequence[float]) -> Command:
        """Try commands that keep the margin; where there is none, slow ones that barely touch nothing."""
        for margin, top in ((self.limits.margin, self.limits.max_vel_x), (CLOSE, self.limits.creep_vel_x)):
            found = self._best(
                now, carrot, Trial(self._speeds(now, top), margin, self.limits.comfort, (1.0, 0.25, 0.6))
            )
            # Who faces a point and can only turn is stuck.
            if found is not None and (found.linear >= 0.02 or abs(now.bearing(carrot)) > FACING):
                return Command(FollowOutcome.DRIVING, found)
        return Command(FollowOutcome.BLOCKED)

    def _speeds(self, now: Situation, top: float) -> np.ndarray:
        """Return the speeds (m/s) within reach of the accelerations, and a stop to turn on the spot."""
        acceleration = self.limits.acc_lim_x
        top = min(top, math.sqrt(acceleration * max(now.distance(self._points[-1]), 0.01)))
        high = min(top, max(0.0, now.velocity.linear) + acceleration * now.period)
        low = max(0.0, min(high, now.velocity.linear - acceleration * now.period))
        speeds = low + (high - low) * self._slower
        speeds[-1] = 0.0
        return speeds

    def _best(self, now: Situation, carrot: Sequence[float], trial: Trial) -> Optional[Velocity]:
        """Return the best command that is safe and moves the robot, None where there is none."""
        limits, scale = self.limits, 1.0 / now.costmap.resolution
        reach = limits.acc_lim_theta * now.period
        low = max(-limits.max_vel_theta, now.velocity.angular - reach)
        high = min(limits.max_vel_theta, now.velocity.angular + reach)
        turns = np.append(0.5 * (low + high) + 0.5 * (high - low) * self._turns, 0.0)
        to_carrot, to_angle, to_room = trial.weights
        i, j, _ = best_command(
            now.costmap.clearance,
            now.costmap.occupied,
            self._body_for(now.costmap.resolution),
            np.array([*now.costmap.to_cells(now.pose.x, now.pose.y), now.pose.yaw]),
            trial.speeds * scale,
            turns,
            np.array(now.costmap.to_cells(*carrot)),
            trial.margin * scale,
            trial.comfort * scale,
            self._horizon(now),
            STEPS,
            np.array([to_carrot / scale, to_angle, to_room / scale]),
        )
        if i < 0:
            return None
        velocity = Velocity(float(trial.speeds[i]), float(turns[j]))
        return velocity if abs(velocity.linear) >= 0.01 or abs(velocity.angular) >= 0.05 else None

    def _horizon(self, now: Situation) -> float:
        """Return how far ahead (s) to look: less when the goal is near, so that the arc does not end beyond it."""
        return max(0.6, min(self.limits.sim_time, 2.0 * now.distance(self._points[-1]) / self.limits.max_vel_x))

    def _body_for(self, resolution: float) -> np.ndarray:
        if self._body[0] != resolution:
            self._body = (resolution, body_discs(self.radius, self.footprint, resolution))
        return self._body[1]

    def _carrot(self, now: Situation) -> Optional[Tuple[float, float]]:
        """Return the point furthest ahead on the path that a straight line leads to, None where that is too near."""
        self._advance(now.pose)
        costmap = now.costmap
        points = points_at(self._points, self._along, self._index, self._ahead)
        inner, scale = self._inner / costmap.resolution, 1.0 / costmap.resolution
        i = furthest_clear(
            costmap.clearance,
            *costmap.to_cells(now.pose.x, now.pose.y),
            (points - (costmap.grid.origin_x, costmap.grid.origin_y)) * scale,
            min(1.2, now.distance(self._points[-1]) * scale) - 1e-6,
            # Only a direction: what is driven is tried for safety. So, in a tight place, a line may graze something.
            np.array([inner, inner - 0.25, inner - 0.5]),
        )
        return (float(points[i, 0]), float(points[i, 1])) if i >= 0 else None

    def _advance(self, pose: Pose2D) -> None:
        """Move on to the path's point nearest to the robot; never back."""
        self._index = int(nearest_index(self._points, self._index, 12, pose.x, pose.y))

    def _turn(self, now: Situation, error: float, final: bool = False) -> Command:
        """Turn on the spot by ``error`` rad; ``final``: that is all that is left to do."""
        if now.velocity.linear > 0.05:
            return Command(FollowOutcome.DRIVING, STOP)
        if final and abs(error) <= self.limits.yaw_goal_tolerance:
            done = abs(now.velocity.angular) < 0.2 or abs(error) < 0.25 * self.limits.yaw_goal_tolerance
            return Command(FollowOutcome.REACHED if done else FollowOutcome.DRIVING)
        rate = math.copysign(min(self.limits.max_vel_theta, self.limits.turn_gain * abs(error) + 0.03), error)
        if not self.may_turn(now.costmap, now.pose, rate):
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
