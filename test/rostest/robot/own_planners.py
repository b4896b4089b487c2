"""Plugins as a user would write them, named by class path in navigation_plugins.test."""

import math
import time

import numpy as np
import rospy

from rosoclingo.robot.navigation import (
    GlobalPlan,
    GridPlanner,
    LocalPlanner,
    PlanOutcome,
    RecoveryBehavior,
    RolloutFollower,
    Velocity,
)
from rosoclingo.robot.navigation.recovery_behaviors import RecoveryStep


class Surveyor(GridPlanner):
    """Plans as the grid planner does, through a waypoint; fails or finds no path on demand of the test.

    For a goal between x 12 and 12.5 it searches until nobody waits any more.
    """

    def __init__(self, parameters=None):
        parameters = dict(parameters or {})
        self.waypoint = parameters.pop("waypoint")
        super().__init__(parameters)

    def plan(self, costmap, start, goal, tolerance=None):
        while 12.0 < goal.x < 12.5 and not self.is_cancelled():
            rospy.set_param("/looks_for_chart", True)
            time.sleep(0.05)
        if goal.x > 14.0:
            raise RuntimeError("the surveyor has lost his chart")
        if goal.x > 13.0:
            return GlobalPlan(PlanOutcome.BLOCKED, np.empty((0, 2)))
        half = start._replace(x=self.waypoint[0], y=self.waypoint[1])
        if start.x > half.x - 0.3 or goal.x < half.x:
            return super().plan(costmap, start, goal, tolerance)
        parts = [super(Surveyor, self).plan(costmap, *ends) for ends in ((start, half), (half, goal))]
        if any(part.outcome is not PlanOutcome.FOUND for part in parts):
            return super().plan(costmap, start, goal, tolerance)
        return GlobalPlan(PlanOutcome.FOUND, np.concatenate([part.points for part in parts]))


class Stroller(LocalPlanner):
    """Delegates to another follower, limits the speed, and returns NaN if the test demands it."""

    def __init__(self, parameters=None, radius=0.18, footprint=()):
        super().__init__(parameters, radius, footprint)
        self._follower = RolloutFollower({"max_vel_x": self.parameters["top_speed"]}, radius, footprint)
        self._goal = None

    def set_plan(self, points, goal):
        self._goal = goal
        self._follower.set_plan(points, goal)

    def length_left(self, pose):
        return self._follower.length_left(pose)

    def compute(self, costmap, pose, velocity, period):
        command = self._follower.compute(costmap, pose, velocity, period)
        if self._goal.x < 1.0:
            return command._replace(velocity=Velocity(math.nan, 0.0))
        return command


class Patience(RecoveryBehavior):
    """Stands still for some control periods."""

    def start(self, now, pose):
        self._left = self.parameters["periods"]

    def step(self, now, pose, costmap, follower):
        self._left -= 1
        return RecoveryStep(done=self._left <= 0)
