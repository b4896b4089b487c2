"""The local planner: from a path and what is near to the next velocity."""

import math
from typing import Optional, Sequence, Union

import numpy as np

from rosoclingo.robot.navigation.body import Body, BodyState, Point
from rosoclingo.robot.navigation.compiled.path import least_along, place_on
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D, normalize_angle
from rosoclingo.robot.navigation.local_planner import STOP, FollowOutcome, LocalPlanner, Velocity, VelocityCommand
from rosoclingo.robot.navigation.navigation_types import FollowerLimits

# A point that close (m) is turned to before it is driven to; beyond BEHIND (rad) any point is.
NEAR, ASIDE, BEHIND, FACING = 0.15, 0.15, 1.2, 0.3
EXACT = 0.01  # m: a robot that is there is at the goal
CLOSE = 0.005  # m that are kept free even where it is tight, unless there are less already
RUSH = 0.08  # s: by this times the speed above creeping more room is needed, as commands come late
WINDOW = 1.5  # m of the path within which the robot is looked for
# A robot that has come less than GAIN (m) further in LULL (s) tries what needs less room; after PATIENCE (s) it reports
# the place as blocked.
GAIN, LULL, PATIENCE = 0.05, 3.0, 8.0
SPARE = 0.01  # m more than it needs to turn, where it leaves a place in which it cannot
CREEPING = np.array([1.0, 0.5, 0.25, 0.0, -0.5, -1.0])  # parts of the speed there


class RolloutFollower(LocalPlanner):
    """Tries commands on the clearance field and takes the safe one that leads best to a point ahead on the path."""

    def __init__(self, parameters: Optional[dict] = None, radius: float = 0.18, footprint: Sequence = ()) -> None:
        super().__init__(parameters, radius, footprint)
        limits = self.limits = FollowerLimits(**self.parameters)
        self._points, self._along = np.empty((0, 2)), np.empty(0)
        # Beyond what the robot can drive in a trial, else it would go slower so as to end at the point.
        self._ahead = np.linspace(0.0, max(limits.lookahead, 1.2 * limits.sim_time * limits.max_vel_x), 9)
        self._turns = np.linspace(-1.0, 1.0, limits.vtheta_samples)
        self._slower = np.linspace(1.0, 0.0, limits.vx_samples)
        self._goal = Pose2D(0.0, 0.0)
        self._index, self._place = 0, 0.0
        self._arrived = False
        self._body = Body(radius, footprint)
        self._circle = Body(self._body.outer)  # in which it can turn
        self._least, self._lull = -1.0, 0.0  # what is left of the path at least, and since when (s)
        self._curvature: Optional[float] = None  # 1/m, of the arc on which it escapes

    def set_plan(self, points: np.ndarray, goal: Pose2D) -> None:
        """Take a new path; see :class:`LocalPlanner`."""
        if goal != self._goal:
            self._arrived, self._lull, self._curvature = False, 0.0, None
        self._points, self._goal = np.ascontiguousarray(points, dtype=np.float64), goal
        self._index, self._place, self._least = 0, 0.0, -1.0
        steps = np.hypot(*np.diff(self._points, axis=0).T) if len(points) > 1 else np.empty(0)
        self._along = np.concatenate(([0.0], np.cumsum(steps)))

    def compute(self, costmap: Costmap, pose: Pose2D, velocity: Velocity, period: float) -> VelocityCommand:
        """Return the next command; see :class:`LocalPlanner`."""
        if not len(self._points):
            return VelocityCommand(FollowOutcome.OFF_PATH)
        now = BodyState(self._body, costmap, pose, velocity, period)
        # Once there the robot only turns: what it drifts while turning must not send it off again (twice is leaving).
        tolerance = self.limits.xy_goal_tolerance * (2.0 if self._arrived else 1.0)
        self._arrived = now.distance(self._points[-1]) <= tolerance
        if self._arrived:
            command = self._turn_to_goal(now)
            if command.outcome is not FollowOutcome.BLOCKED or now.distance(self._points[-1]) <= EXACT:
                return command
            self._arrived = False  # nearer to the goal there may be room
        self._watch(now)
        found = self._escape(now) if self._lull >= LULL else self._follow(now)
        if found:
            return VelocityCommand(FollowOutcome.DRIVING, found).stopping_first(velocity)
        return self._creep(now)

    def length_left(self, pose: Pose2D) -> float:
        """Return what is left of the path; see :class:`LocalPlanner`."""
        if not len(self._points):
            return math.inf
        self._index, self._place, away = place_on(self._points, self._along, self._index, WINDOW, pose.x, pose.y)
        return float(away + self._along[-1] - self._place)

    def may_turn(self, costmap: Costmap, pose: Pose2D, rate: float) -> bool:
        """Return whether turning on the spot at ``rate`` rad/s touches nothing that the robot does not touch now."""
        return BodyState(self._body, costmap, pose, STOP, 0.0).may_turn(0.4 * rate)

    def _watch(self, now: BodyState) -> None:
        """Update for how long the robot has come no further."""
        left = self.length_left(now.pose)
        self._lull += now.period
        if self._least < 0.0:  # a new path
            self._least = left
        elif left < self._least - GAIN:
            self._least, self._lull = left, 0.0

    def _at(self, places: Union[float, np.ndarray]) -> np.ndarray:
        """Return the points (m) of the path at places (m) along it."""
        return np.stack([np.interp(places, self._along, self._points[:, axis]) for axis in (0, 1)], axis=-1)

    def _follow(self, now: BodyState) -> Optional[Velocity]:
        """Return the command towards a point ahead on the path, None where none keeps enough room."""
        ahead = self._at(self._place + self._ahead)
        # Where it has the room to turn, and on a path that has, it is to keep that; else it must get straight in.
        if self.footprint and now.has_room([now.pose[:2], *ahead]):
            now = BodyState(self._circle, now.costmap, now.pose, now.velocity, now.period)
        carrot = self._carrot(now, ahead)
        if carrot is None:
            return None
        bearing = now.bearing(carrot)
        aside = abs(bearing) > (ASIDE if now.distance(carrot) < NEAR else BEHIND)
        if aside and now.velocity.linear < 0.1:
            return self._turn(now, bearing)
        return self._drive(now, carrot) or (self._turn(now, bearing) if abs(bearing) > 0.1 else None)

    def _carrot(self, now: BodyState, ahead: np.ndarray) -> Optional[np.ndarray]:
        """Return the point furthest ahead that a straight line leads to, None where that is too near."""
        costmap, scale = now.costmap, now.costmap.resolution
        x, y = costmap.to_cells(now.pose.x, now.pose.y)
        lines = costmap.all_to_cells(ahead).tolist()
        room = np.array([least_along(costmap.clearance, x, y, *end) for end in lines])
        nearest = min(1.2 * scale, now.distance(self._points[-1])) - 1e-6
        room[np.hypot(*(ahead - now.pose[:2]).T) < nearest] = -np.inf
        # Only a direction: what is driven is tried for safety. So, in a tight place, a line may graze something.
        for less in (0.0, 0.25, 0.5):
            clear = np.flatnonzero(room >= now.body.inner / scale - less)
            if len(clear):
                return np.asarray(ahead[clear[-1]])
        return None

    def _drive(self, now: BodyState, carrot: Point) -> Optional[Velocity]:
        """Try commands that keep the margin, and more of it the faster they are."""
        limits = self.limits
        speeds = self._speeds(now)
        needs = limits.margin + RUSH * np.maximum(0.0, speeds - limits.creep_vel_x)
        # The slowest need no more room than there is.
        needs[speeds <= max(limits.creep_vel_x, speeds[-2])] = -limits.margin
        found = self._best(now, carrot, speeds, needs, limits.max_vel_theta)
        # A robot that faces a point and can only turn is stuck.
        stuck = found and found.linear < 0.02 and abs(now.bearing(carrot)) <= FACING
        return None if stuck else found

    def _speeds(self, now: BodyState) -> np.ndarray:
        """Return the speeds (m/s) within reach of the accelerations, and a stop to turn on the spot."""
        acceleration = self.limits.acc_lim_x
        top = min(self.limits.max_vel_x, math.sqrt(acceleration * max(now.distance(self._points[-1]), 0.01)))
        high = min(top, max(0.0, now.velocity.linear) + acceleration * now.period)
        low = max(0.0, min(high, now.velocity.linear - acceleration * now.period))
        return np.append(low + (high - low) * self._slower, 0.0)

    def _best(
        self, now: BodyState, carrot: Point, speeds: np.ndarray, needs: np.ndarray, rate: float
    ) -> Optional[Velocity]:
        """Return the best command that is safe and moves the robot, turning by ``rate`` (rad/s) at most."""
        limits, angular = self.limits, now.velocity.angular
        reach = limits.acc_lim_theta * now.period
        low, high = max(-rate, min(rate, angular) - reach), min(rate, max(-rate, angular) + reach)
        turns = np.append(0.5 * (low + high) + 0.5 * (high - low) * self._turns, 0.0)
        # Look less far ahead when the goal is near, so that the arc does not end beyond it.
        horizon = max(0.6, min(limits.sim_time, 2.0 * now.distance(self._points[-1]) / limits.max_vel_x))
        found = now.best_command(speeds, needs, turns, carrot, limits.comfort, horizon)
        return found if found and (abs(found.linear) >= 0.01 or abs(found.angular) >= 0.05) else None

    def _escape(self, now: BodyState) -> Optional[Velocity]:
        """Return the command that leads to where the robot can turn, None where it can or none does."""
        if not self.footprint or now.has_room([now.pose[:2]], 0.5 * SPARE):
            return None
        found = now.arc_to_room(SPARE, self.limits.creep_vel_x, self._curvature)
        self._curvature = found.angular / found.linear if found else None
        return found

    def _creep(self, now: BodyState) -> VelocityCommand:
        """Go on slowly, backwards too, with as little room as there is; report the path as blocked after a while."""
        point, creep, most = self._at(self._place + NEAR), self.limits.creep_vel_x, self.limits.max_vel_theta
        # No corner is to be faster than that.
        rate = min(most, creep / self._body.outer) if self.footprint else most
        found = self._best(now, point, CREEPING * creep, np.full(len(CREEPING), -CLOSE), rate)
        if found is None or self._lull > PATIENCE:
            self._lull = 0.0
            x, y = point.tolist()
            return VelocityCommand(FollowOutcome.BLOCKED, STOP, (x, y))
        return VelocityCommand(FollowOutcome.DRIVING, found).stopping_first(now.velocity)

    def _turn(self, now: BodyState, error: float) -> Optional[Velocity]:
        """Return the command that turns on the spot by ``error`` rad, the other way round if need be; None for none."""
        if abs(now.velocity.linear) > 0.05:
            return STOP
        for angle in (error, error - math.copysign(2.0 * math.pi, error)):
            if now.may_turn(angle):
                rate = min(self.limits.max_vel_theta, self.limits.turn_gain * abs(angle) + 0.03)
                before = max(0.0, math.copysign(now.velocity.angular, now.velocity.angular * angle))
                return Velocity(0.0, math.copysign(min(rate, before + self.limits.acc_lim_theta * now.period), angle))
        return None

    def _turn_to_goal(self, now: BodyState) -> VelocityCommand:
        """Return the command of a robot that is at its goal and only has to turn."""
        error, tolerance = normalize_angle(self._goal.yaw - now.pose.yaw), self.limits.yaw_goal_tolerance
        if abs(error) <= tolerance and abs(now.velocity.linear) <= 0.05:
            done = abs(now.velocity.angular) < 0.2 or abs(error) < 0.25 * tolerance
            return VelocityCommand(FollowOutcome.REACHED if done else FollowOutcome.DRIVING)
        turn = self._turn(now, error)
        return VelocityCommand(FollowOutcome.DRIVING, turn) if turn else VelocityCommand(FollowOutcome.BLOCKED)
