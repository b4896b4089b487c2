"""Occupancy grids, costmaps, path planning, path following and recovery (pure)."""

from typing import TYPE_CHECKING

from rosoclingo.common.lazy import loader

if TYPE_CHECKING:
    from rosoclingo.robot.navigation.costmap import Costmap, CostmapLimits
    from rosoclingo.robot.navigation.follower import RolloutFollower
    from rosoclingo.robot.navigation.geometry import Pose2D, normalize_angle, quaternion_to_yaw, yaw_to_quaternion
    from rosoclingo.robot.navigation.grid import MapError, OccupancyGrid, load_map
    from rosoclingo.robot.navigation.grid_planner import (
        GlobalPlanner,
        GridPlanner,
        GridPlannerLimits,
        Plan,
        PlanOutcome,
    )
    from rosoclingo.robot.navigation.local_planner import Command, FollowOutcome, LocalPlanner, Velocity
    from rosoclingo.robot.navigation.navigation_types import (
        FollowerLimits,
        NavigationError,
        NavigatorLimits,
        Outcome,
        Result,
        State,
        Tick,
    )
    from rosoclingo.robot.navigation.navigator import Navigator
    from rosoclingo.robot.navigation.patience import PatienceClock
    from rosoclingo.robot.navigation.recovery_behaviors import (
        ClearCostmap,
        RecoveryBehavior,
        RotateRecovery,
        default_recoveries,
    )

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
        "ClearCostmap": "recovery_behaviors",
        "Command": "local_planner",
        "Costmap": "costmap",
        "CostmapLimits": "costmap",
        "FollowOutcome": "local_planner",
        "FollowerLimits": "navigation_types",
        "GlobalPlanner": "grid_planner",
        "GridPlanner": "grid_planner",
        "GridPlannerLimits": "grid_planner",
        "LocalPlanner": "local_planner",
        "MapError": "grid",
        "NavigationError": "navigation_types",
        "Navigator": "navigator",
        "NavigatorLimits": "navigation_types",
        "OccupancyGrid": "grid",
        "Outcome": "navigation_types",
        "PatienceClock": "patience",
        "Plan": "grid_planner",
        "PlanOutcome": "grid_planner",
        "Pose2D": "geometry",
        "RecoveryBehavior": "recovery_behaviors",
        "Result": "navigation_types",
        "RolloutFollower": "follower",
        "RotateRecovery": "recovery_behaviors",
        "State": "navigation_types",
        "Tick": "navigation_types",
        "Velocity": "local_planner",
        "default_recoveries": "recovery_behaviors",
        "load_map": "grid",
        "normalize_angle": "geometry",
        "quaternion_to_yaw": "geometry",
        "yaw_to_quaternion": "geometry",
    },
)
