"""Occupancy grids, costmaps, path planning, path following and recovery (pure)."""

from rosoclingo.navigation.costmap import Costmap, CostmapLimits
from rosoclingo.navigation.follower import FollowerLimits, RolloutFollower
from rosoclingo.navigation.geometry import Pose2D, normalize_angle, quaternion_to_yaw, yaw_to_quaternion
from rosoclingo.navigation.grid import MapError, OccupancyGrid, load_map
from rosoclingo.navigation.local_planner import Command, FollowOutcome, LocalPlanner, Velocity
from rosoclingo.navigation.navigation_types import NavigationError, NavigatorLimits, Outcome, Result, State, Tick
from rosoclingo.navigation.navigator import Navigator
from rosoclingo.navigation.planner import GlobalPlanner, GridPlanner, GridPlannerLimits, Plan, PlanOutcome
from rosoclingo.navigation.recovery import ClearCostmap, RecoveryBehavior, RotateRecovery, default_recoveries

__all__ = [
    "ClearCostmap",
    "Command",
    "Costmap",
    "CostmapLimits",
    "FollowOutcome",
    "FollowerLimits",
    "GlobalPlanner",
    "GridPlanner",
    "GridPlannerLimits",
    "LocalPlanner",
    "MapError",
    "NavigationError",
    "Navigator",
    "NavigatorLimits",
    "OccupancyGrid",
    "Outcome",
    "Plan",
    "PlanOutcome",
    "Pose2D",
    "RecoveryBehavior",
    "Result",
    "RolloutFollower",
    "RotateRecovery",
    "State",
    "Tick",
    "Velocity",
    "default_recoveries",
    "load_map",
    "normalize_angle",
    "quaternion_to_yaw",
    "yaw_to_quaternion",
]
