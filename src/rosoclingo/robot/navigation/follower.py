"""The local planner: from a path and what is near to the next velocity."""

import math
from typing import Optional, Sequence, Tuple

import numpy as np

from rosoclingo.robot.navigation.body import Body, Situation, Trial
from rosoclingo.robot.navigation.compiled.path import furthest_clear, least_at, place_on, points_at
from rosoclingo.robot.navigation.compiled.rollout import best_command
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D, normalize_angle
from rosoclingo.robot.navigation.local_planner import STOP, Command, FollowOutcome, LocalPlanner, Velocity
from rosoclingo.robot.navigation.navigation_types import FollowerLimits
from rosoclingo.robot.navigation.way_out import WayOut

__all__ = ["RolloutFollower"]

# A point that close (m) is turned to before it is driven to; beyond BEHIND (rad) any point is.
NEAR, ASIDE, BEHIND, FACING = 0.15, 0.15, 1.2, 0.3
EXACT = 0.01  # m: a robot that is there is at the goal
CLOSE = 0.005  # m that are kept free even where it is tight, unless there are less already
RUSH = 0.08  # s: by so much times the speed above creeping more room is needed, as commands come late
STEPS = 12  # places looked at along a trial
WINDOW = 1.5  # m of the path within which the robot is looked for
# A robot that has come less than GAIN (m) further in LULL (s) tries what needs less room; after PATIENCE (s) it reports
# the place as blocked.
GAIN, LULL, PATIENCE = 0.05, 3.0, 8.0


class RolloutFollower(LocalPlanner):
    """Tries commands on the clearance field and takes the safe one that leads best to a point ahead on the path."""

    def __init__(self, parameters: Optional[dict] = None, radius: float = 0.18, footprint: Sequence = ()) -> None:
        super().__init__(parameters, radius, footprint)
        limits = self.limits = FollowerLimits(**self.parameters)
        self._points, self._along = np.empty((0, 2)), np.empty(0)
        # Beyond what the robot can drive in a trial, else it would go slower so as to end at the point.
        self._ahead = np.linspace(0.0, max(limits.lookahead, 1.2 * limits.sim_time * limits.max_vel_x), 9)
        self._turns = np.linspace(-1.0, 1.0, limits.vtheta_samples)
        self._slower = np.append(np.linspace(1.0, 0.0, limits.vx_samples), 0.0)
        self._goal = Pose2D(0.0, 0.0)
        self._index, self._place = 0, 0.0
        self._arrived = False
        self._whole = Body(radius, footprint)
        self._circle = Body(self._whole.outer)  # in which it can turn
        self._body = self._whole
        self._way_out = WayOut(limits.creep_vel_x)
        self._least, self._lull = -1.0, 0.0  # what is left of the path at least, and since when (s)

    def set_plan(self, points: np.ndarray, goal: Pose2D) -> None:
        """Take a new path; see :class:`LocalPlanner`."""
        if goal != self._goal:
            self._arrived, self._lull = False, 0.0
            self._way_out.end()
        self._points, self._goal = np.ascontiguousarray(points, dtype=np.float64), goal
        self._index, self._place, self._least = 0, 0.0, -1.0
        steps = np.hypot(*np.diff(self._points, axis=0).T) if len(points) > 1 else np.empty(0)
        self._along = np.concatenate(([0.0], np.cumsum(steps)))

    def compute(self, costmap: Costmap, pose: Pose2D, velocity: Velocity, period: float) -> Command:
        """Return the next command; see :class:`LocalPlanner`."""
        if not len(self._points):
            return Command(FollowOutcome.OFF_PATH)
        self._body = self._whole
        now = self._body.situation(costmap, pose, velocity, period)
        # Once there the robot only turns: what it drifts while turning must not send it off again (twice is leaving).
        tolerance = self.limits.xy_goal_tolerance * (2.0 if self._arrived else 1.0)
        self._arrived = now.distance(self._points[-1]) <= tolerance
        if self._arrived:
            command = self._turn(now, normalize_angle(self._goal.yaw - pose.yaw), final=True)
            if command.outcome is not FollowOutcome.BLOCKED or now.distance(self._points[-1]) <= EXACT:
                return command
            self._arrived = False  # nearer to the goal there may be room
        self._watch(now)
        escape = self._way_out.go_on(self._whole, now)
        if escape is None and self._lull >= LULL and not self._has_room(now, pose[:2]):
            escape = self._way_out.begin(self._whole, now)
        if escape is not None:
            return Command(FollowOutcome.DRIVING, escape).stopping_first(velocity)
        if self.footprint and self._lull < LULL and not self._is_narrow(now) and self._has_room(now, pose[:2]):
            # Where it has the room to turn, and on a way that has, it is to keep that.
            self._body = self._circle
            now = self._body.situation(costmap, pose, velocity, period)
        carrot = self._carrot(now)
        if carrot is not None and self._lull < LULL:
            command = self._towards(now, carrot)
            if command.outcome is not FollowOutcome.BLOCKED:
                return command
        return self._creep(now).stopping_first(velocity)

    def length_left(self, pose: Pose2D) -> float:
        """Return what is left of the path; see :class:`LocalPlanner`."""
        if not len(self._points):
            return math.inf
        self._index, self._place = place_on(self._points, self._along, self._index, WINDOW, pose.x, pose.y)
        x, y = self._at(0.0)
        return math.hypot(x - pose.x, y - pose.y) + float(self._along[-1] - self._place)

    def may_turn(self, costmap: Costmap, pose: Pose2D, rate: float) -> bool:
        """Tell whether turning on the spot at ``rate`` rad/s touches nothing that the robot does not touch now."""
        return self._whole.may_turn(self._whole.situation(costmap, pose, STOP, 0.0), 0.4 * rate)

    def _watch(self, now: Situation) -> None:
        """Keep for how long the robot has come no further."""
        left = self.length_left(now.pose)
        self._lull += now.period
        if self._least < 0.0:  # a new path
            self._least = left
        elif left < self._least - GAIN:
            self._least, self._lull = left, 0.0

    def _at(self, ahead: float) -> Tuple[float, float]:
        """Return the point (m) of the path so far ahead (m)."""
        x, y = points_at(self._points, self._along, self._index, np.array([self._place + ahead]))[0]
        return float(x), float(y)

    def _has_room(self, now: Situation, *points: Sequence[float]) -> bool:
        """Tell whether the robot can turn at points (m); a disc always can."""
        if not self.footprint:
            return True
        cells = now.costmap.all_to_cells(np.array(points))
        return bool(least_at(now.costmap.clearance, cells) * now.costmap.resolution >= self._whole.outer)

    def _is_narrow(self, now: Situation) -> bool:
        """Tell whether the path ahead leads where the robot cannot turn: it must get straight in."""
        return not self._has_room(now, *points_at(self._points, self._along, self._index, self._place + self._ahead))

    def _creep(self, now: Situation) -> Command:
        """Go on slowly, backwards too, with as little room as there is; report the path as blocked after a while."""
        parts = np.array([1.0, 0.5, 0.25, 0.0, -0.5, -1.0])
        rate = self._body.slow_turn(self.limits.creep_vel_x, self.limits.max_vel_theta)
        needs, weights = np.full(len(parts), -CLOSE), (1.0, 0.25, 0.6)
        trial = Trial(parts * self.limits.creep_vel_x, needs, self.limits.comfort, weights, rate)
        found = self._best(now, self._at(NEAR), trial)
        if found is None or self._lull > PATIENCE:
            self._lull = 0.0
            return Command(FollowOutcome.BLOCKED, STOP, self._at(NEAR))
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
        """Try commands that keep the margin, and more of it the faster they are."""
        limits = self.limits
        speeds = self._speeds(now)
        needs = limits.margin + RUSH * np.maximum(0.0, speeds - limits.creep_vel_x)
        # The slowest need no more room than there is.
        needs[speeds <= max(limits.creep_vel_x, speeds[-2])] = -limits.margin
        found = self._best(now, carrot, Trial(speeds, needs, limits.comfort, (1.0, 0.25, 0.6), limits.max_vel_theta))
        # A robot that faces a point and can only turn is stuck.
        if found is None or (found.linear < 0.02 and abs(now.bearing(carrot)) <= FACING):
            return Command(FollowOutcome.BLOCKED)
        return Command(FollowOutcome.DRIVING, found)

    def _speeds(self, now: Situation) -> np.ndarray:
        """Return the speeds (m/s) within reach of the accelerations, and a stop to turn on the spot."""
        acceleration = self.limits.acc_lim_x
        top = min(self.limits.max_vel_x, math.sqrt(acceleration * max(now.distance(self._points[-1]), 0.01)))
        high = min(top, max(0.0, now.velocity.linear) + acceleration * now.period)
        low = max(0.0, min(high, now.velocity.linear - acceleration * now.period))
        speeds = low + (high - low) * self._slower
        speeds[-1] = 0.0
        return speeds

    def _best(self, now: Situation, carrot: Sequence[float], trial: Trial) -> Optional[Velocity]:
        """Return the best command that is safe and moves the robot, None where there is none."""
        limits, scale = self.limits, 1.0 / now.costmap.resolution
        reach = limits.acc_lim_theta * now.period
        low = max(-trial.rate, min(trial.rate, now.velocity.angular) - reach)
        high = min(trial.rate, max(-trial.rate, now.velocity.angular) + reach)
        turns = np.append(0.5 * (low + high) + 0.5 * (high - low) * self._turns, 0.0)
        to_carrot, to_angle, to_room = trial.weights
        i, j = best_command(
            now.around,
            self._body.pieces(now.costmap.resolution),
            np.array(now.cells),
            trial.speeds * scale,
            turns,
            np.array(now.costmap.to_cells(*carrot)),
            trial.needs * scale,
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

    def _carrot(self, now: Situation) -> Optional[Tuple[float, float]]:
        """Return the point furthest ahead on the path that a straight line leads to, None where that is too near."""
        costmap = now.costmap
        points = points_at(self._points, self._along, self._index, self._place + self._ahead)
        inner = self._body.inner / costmap.resolution
        i = furthest_clear(
            costmap.clearance,
            *costmap.to_cells(now.pose.x, now.pose.y),
            costmap.all_to_cells(points),
            min(1.2, now.distance(self._points[-1]) / costmap.resolution) - 1e-6,
            # Only a direction: what is driven is tried for safety. So, in a tight place, a line may graze something.
            np.array([inner, inner - 0.25, inner - 0.5]),
        )
        return (float(points[i, 0]), float(points[i, 1])) if i >= 0 else None

    def _turn(self, now: Situation, error: float, final: bool = False) -> Command:
        """Turn on the spot by ``error`` rad; ``final``: that is all that is left to do."""
        if abs(now.velocity.linear) > 0.05:
            return Command(FollowOutcome.DRIVING, STOP)
        if final and abs(error) <= self.limits.yaw_goal_tolerance:
            done = abs(now.velocity.angular) < 0.2 or abs(error) < 0.25 * self.limits.yaw_goal_tolerance
            return Command(FollowOutcome.REACHED if done else FollowOutcome.DRIVING)
        for angle in (error, error - math.copysign(2.0 * math.pi, error)):
            if self._body.may_turn(now, angle):
                rate = min(self.limits.max_vel_theta, self.limits.turn_gain * abs(angle) + 0.03)
                turn = now.eased(math.copysign(rate, angle), self.limits.acc_lim_theta)
                return Command(FollowOutcome.DRIVING, Velocity(0.0, turn))
        return Command(FollowOutcome.BLOCKED)
