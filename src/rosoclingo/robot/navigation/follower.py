"""Local planner that samples velocities and simulates each of them."""

import math
from typing import Optional, Sequence, Union

import numpy as np

from rosoclingo.robot.navigation.body import Body, BodyState, Point
from rosoclingo.robot.navigation.compiled.path import least_along, place_on
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D, normalize_angle
from rosoclingo.robot.navigation.local_planner import STOP, FollowOutcome, LocalPlanner, Velocity, VelocityCommand
from rosoclingo.robot.navigation.navigation_types import FollowerLimits

# The robot turns before it drives to a target nearer than NEAR_TARGET (m) and more than TURN_ANGLE (rad) off its
# heading, and to any target more than ANY_TURN_ANGLE (rad) off. Within FACING_ANGLE (rad) it faces the target.
NEAR_TARGET, TURN_ANGLE, ANY_TURN_ANGLE, FACING_ANGLE = 0.15, 0.15, 1.2, 0.3
GOAL_PRECISION = 0.01  # m: within this distance the robot does not move closer to the goal
MIN_CLEARANCE = 0.005  # m: minimum clearance in tight places, unless the present clearance is smaller
COMMAND_DELAY = 0.08  # s: the required clearance grows by this time x (speed - creep speed), as commands come late
SEARCH_WINDOW = 1.5  # m: length of the path that is searched for the robot's position
# After LULL_TIMEOUT (s) with less than MIN_PROGRESS (m) of progress the robot tries manoeuvres that need less room.
# After BLOCKED_TIMEOUT (s) it reports the path as blocked.
MIN_PROGRESS, LULL_TIMEOUT, BLOCKED_TIMEOUT = 0.05, 3.0, 8.0
CREEP_FACTORS = np.array([1.0, 0.5, 0.25, 0.0, -0.5, -1.0])  # speeds in tight places, relative to creep_vel_x


class RolloutFollower(LocalPlanner):
    """Selects the safe velocity that leads best to a point ahead on the path."""

    def __init__(self, parameters: Optional[dict] = None, radius: float = 0.18, footprint: Sequence = ()) -> None:
        super().__init__(parameters, radius, footprint)
        limits = self.limits = FollowerLimits(**self.parameters)
        self._points, self._along = np.empty((0, 2)), np.empty(0)
        # The target lies beyond the end of a rollout: otherwise the robot would slow down to end at the target.
        self._ahead = np.linspace(0.0, max(limits.lookahead, 1.2 * limits.sim_time * limits.max_vel_x), 9)
        self._turns = np.linspace(-1.0, 1.0, limits.vtheta_samples)
        self._slower = np.linspace(1.0, 0.0, limits.vx_samples)
        self._goal = Pose2D(0.0, 0.0)
        self._index, self._place = 0, 0.0
        self._arrived = False
        self._body = Body(radius, footprint)
        self._least, self._lull = -1.0, 0.0  # shortest remaining path (m), and time without progress (s)

    def set_plan(self, points: np.ndarray, goal: Pose2D) -> None:
        """Set a new path; see :class:`LocalPlanner`."""
        if goal != self._goal:
            self._arrived, self._lull = False, 0.0
        self._points, self._goal = np.ascontiguousarray(points, dtype=np.float64), goal
        self._index, self._place, self._least = 0, 0.0, -1.0
        steps = np.hypot(*np.diff(self._points, axis=0).T) if len(points) > 1 else np.empty(0)
        self._along = np.concatenate(([0.0], np.cumsum(steps)))

    def compute(self, costmap: Costmap, pose: Pose2D, velocity: Velocity, period: float) -> VelocityCommand:
        """Return the next command; see :class:`LocalPlanner`."""
        if not len(self._points):
            return VelocityCommand(FollowOutcome.OFF_PATH)
        now = BodyState(self._body, costmap, pose, velocity, period)
        # At the goal the robot only turns. The doubled tolerance keeps drift during the turn from restarting the drive.
        tolerance = self.limits.xy_goal_tolerance * (2.0 if self._arrived else 1.0)
        self._arrived = now.distance(self._points[-1]) <= tolerance
        if self._arrived:
            command = self._turn_to_goal(now)
            if command.outcome is not FollowOutcome.BLOCKED or now.distance(self._points[-1]) <= GOAL_PRECISION:
                return command
            self._arrived = False  # closer to the goal there can be enough room to turn
        self._watch(now)
        found = None if self._lull >= LULL_TIMEOUT else self._follow(now)
        if found:
            return VelocityCommand(FollowOutcome.DRIVING, found).stopping_first(velocity)
        return self._creep(now)

    def length_left(self, pose: Pose2D) -> float:
        """Return the remaining length of the path; see :class:`LocalPlanner`."""
        if not len(self._points):
            return math.inf
        self._index, self._place, away = place_on(self._points, self._along, self._index, SEARCH_WINDOW, pose.x, pose.y)
        return float(away + self._along[-1] - self._place)

    def can_turn(self, costmap: Costmap, pose: Pose2D, rate: float) -> bool:
        """Return whether the robot can turn on the spot at ``rate`` rad/s without a new contact."""
        return BodyState(self._body, costmap, pose, STOP, 0.0).can_turn(0.4 * rate)

    def _watch(self, now: BodyState) -> None:
        """Update the time without progress."""
        left = self.length_left(now.pose)
        self._lull += now.period
        if self._least < 0.0:  # a new path
            self._least = left
        elif left < self._least - MIN_PROGRESS:
            self._least, self._lull = left, 0.0

    def _at(self, places: Union[float, np.ndarray]) -> np.ndarray:
        """Return the points (m) at distances (m) along the path."""
        return np.stack([np.interp(places, self._along, self._points[:, axis]) for axis in (0, 1)], axis=-1)

    def _follow(self, now: BodyState) -> Optional[Velocity]:
        """Return the command towards a point ahead on the path, or None if no safe command exists."""
        ahead = self._at(self._place + self._ahead)
        carrot = self._carrot(now, ahead)
        if carrot is None:
            return None
        bearing = now.bearing(carrot)
        aside = abs(bearing) > (TURN_ANGLE if now.distance(carrot) < NEAR_TARGET else ANY_TURN_ANGLE)
        if aside and now.velocity.linear < 0.1:
            return self._turn(now, bearing)
        return self._drive(now, carrot) or (self._turn(now, bearing) if abs(bearing) > 0.1 else None)

    def _carrot(self, now: BodyState, ahead: np.ndarray) -> Optional[np.ndarray]:
        """Return the furthest point ahead with a clear straight line, or None if that point is too near."""
        costmap, scale = now.costmap, now.costmap.resolution
        x, y = costmap.to_cells(now.pose.x, now.pose.y)
        lines = costmap.all_to_cells(ahead).tolist()
        room = np.array([least_along(costmap.clearance, x, y, *end) for end in lines])
        nearest = min(1.2 * scale, now.distance(self._points[-1])) - 1e-6
        room[np.hypot(*(ahead - now.pose[:2]).T) < nearest] = -np.inf
        # The target only gives a direction; commands are checked later. So a line can graze obstacles in tight places.
        for less in (0.0, 0.25, 0.5):
            clear = np.flatnonzero(room >= now.body.inner / scale - less)
            if len(clear):
                return np.asarray(ahead[clear[-1]])
        return None

    def _drive(self, now: BodyState, carrot: Point) -> Optional[Velocity]:
        """Return the best command whose clearance is at least the margin, and more at higher speeds."""
        limits = self.limits
        speeds = self._speeds(now)
        needs = limits.margin + COMMAND_DELAY * np.maximum(0.0, speeds - limits.creep_vel_x)
        # At the lowest speeds the present clearance is enough.
        needs[speeds <= max(limits.creep_vel_x, speeds[-2])] = -limits.margin
        found = self._best(now, carrot, speeds, needs, limits.max_vel_theta)
        # A robot that faces the target but can only turn is stuck.
        stuck = found and found.linear < 0.02 and abs(now.bearing(carrot)) <= FACING_ANGLE
        return None if stuck else found

    def _speeds(self, now: BodyState) -> np.ndarray:
        """Return the speeds (m/s) that the acceleration limits allow, and 0 for turning on the spot."""
        acceleration = self.limits.acc_lim_x
        top = min(self.limits.max_vel_x, math.sqrt(acceleration * max(now.distance(self._points[-1]), 0.01)))
        high = min(top, max(0.0, now.velocity.linear) + acceleration * now.period)
        low = max(0.0, min(high, now.velocity.linear - acceleration * now.period))
        return np.append(low + (high - low) * self._slower, 0.0)

    def _best(
        self, now: BodyState, carrot: Point, speeds: np.ndarray, needs: np.ndarray, rate: float
    ) -> Optional[Velocity]:
        """Return the best safe command that moves the robot, with at most ``rate`` rad/s."""
        limits, angular = self.limits, now.velocity.angular
        reach = limits.acc_lim_theta * now.period
        low, high = max(-rate, min(rate, angular) - reach), min(rate, max(-rate, angular) + reach)
        turns = np.append(0.5 * (low + high) + 0.5 * (high - low) * self._turns, 0.0)
        # Shorten the horizon near the goal, so that arcs do not end beyond it.
        horizon = max(0.6, min(limits.sim_time, 2.0 * now.distance(self._points[-1]) / limits.max_vel_x))
        found = now.best_command(speeds, needs, turns, carrot, limits.comfort, horizon)
        return found if found and (abs(found.linear) >= 0.01 or abs(found.angular) >= 0.05) else None

    def _creep(self, now: BodyState) -> VelocityCommand:
        """Drive slowly, possibly backwards, with minimum clearance; report a blocked path after BLOCKED_TIMEOUT."""
        point, creep, most = self._at(self._place + NEAR_TARGET), self.limits.creep_vel_x, self.limits.max_vel_theta
        # Limits the speed of the outermost corner to the creep speed.
        rate = min(most, creep / self._body.outer) if self.footprint else most
        found = self._best(now, point, CREEP_FACTORS * creep, np.full(len(CREEP_FACTORS), -MIN_CLEARANCE), rate)
        if found is None or self._lull > BLOCKED_TIMEOUT:
            self._lull = 0.0
            x, y = point.tolist()
            return VelocityCommand(FollowOutcome.BLOCKED, STOP, (x, y))
        return VelocityCommand(FollowOutcome.DRIVING, found).stopping_first(now.velocity)

    def _turn(self, now: BodyState, error: float) -> Optional[Velocity]:
        """Return the command to turn on the spot by ``error`` rad, in either direction; None if both are blocked."""
        if abs(now.velocity.linear) > 0.05:
            return STOP
        for angle in (error, error - math.copysign(2.0 * math.pi, error)):
            if now.can_turn(angle):
                rate = min(self.limits.max_vel_theta, self.limits.turn_gain * abs(angle) + 0.03)
                before = max(0.0, math.copysign(now.velocity.angular, now.velocity.angular * angle))
                return Velocity(0.0, math.copysign(min(rate, before + self.limits.acc_lim_theta * now.period), angle))
        return None

    def _turn_to_goal(self, now: BodyState) -> VelocityCommand:
        """Return the command for a robot at its goal position, which only has to turn."""
        error, tolerance = normalize_angle(self._goal.yaw - now.pose.yaw), self.limits.yaw_goal_tolerance
        if abs(error) <= tolerance and abs(now.velocity.linear) <= 0.05:
            done = abs(now.velocity.angular) < 0.2 or abs(error) < 0.25 * tolerance
            return VelocityCommand(FollowOutcome.REACHED if done else FollowOutcome.DRIVING)
        turn = self._turn(now, error)
        return VelocityCommand(FollowOutcome.DRIVING, turn) if turn else VelocityCommand(FollowOutcome.BLOCKED)
