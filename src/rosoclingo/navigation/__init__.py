"""Occupancy grids, costmaps, path planning, path following and recovery (pure)."""

from typing import TYPE_CHECKING

from rosoclingo.lazy import loader

if TYPE_CHECKING:
    from rosoclingo.navigation.costmap import Costmap, CostmapLimits
    from rosoclingo.navigation.follower import RolloutFollower
    from rosoclingo.navigation.geometry import Pose2D, normalize_angle, quaternion_to_yaw, yaw_to_quaternion
    from rosoclingo.navigation.grid import MapError, OccupancyGrid, load_map
    from rosoclingo.navigation.local_planner import Command, FollowOutcome, LocalPlanner, Velocity
    from rosoclingo.navigation.navigation_types import (
        FollowerLimits,
        NavigationError,
        NavigatorLimits,
        Outcome,
        Result,
        State,
        Tick,
    )
    from rosoclingo.navigation.navigator import Navigator
    from rosoclingo.navigation.patience import PatienceClock
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
    "PatienceClock",
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

__getattr__ = loader(
    __name__,
    {
        "ClearCostmap": "recovery",
        "Command": "local_planner",
        "Costmap": "costmap",
        "CostmapLimits": "costmap",
        "FollowOutcome": "local_planner",
        "FollowerLimits": "navigation_types",
        "GlobalPlanner": "planner",
        "GridPlanner": "planner",
        "GridPlannerLimits": "planner",
        "LocalPlanner": "local_planner",
        "MapError": "grid",
        "NavigationError": "navigation_types",
        "Navigator": "navigator",
        "NavigatorLimits": "navigation_types",
        "OccupancyGrid": "grid",
        "Outcome": "navigation_types",
        "PatienceClock": "patience",
        "Plan": "planner",
        "PlanOutcome": "planner",
        "Pose2D": "geometry",
        "RecoveryBehavior": "recovery",
        "Result": "navigation_types",
        "RolloutFollower": "follower",
        "RotateRecovery": "recovery",
        "State": "navigation_types",
        "Tick": "navigation_types",
        "Velocity": "local_planner",
        "default_recoveries": "recovery",
        "load_map": "grid",
        "normalize_angle": "geometry",
        "quaternion_to_yaw": "geometry",
        "yaw_to_quaternion": "geometry",
    },
)
