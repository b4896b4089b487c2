"""Occupancy grids, costmaps, path planning, path following and recovery (pure)."""

from rosoclingo.common.lazy import loader

# Public names, by the module that defines them; loaded on first use.
_NAMES = {
    "costmap": "Costmap CostmapLimits",
    "follower": "RolloutFollower",
    "geometry": "Pose2D normalize_angle quaternion_to_yaw yaw_to_quaternion",
    "grid": "MapError OccupancyGrid load_map",
    "grid_planner": "GlobalPlan GlobalPlanner GridPlanner GridPlannerLimits PlanOutcome",
    "local_planner": "FollowOutcome LocalPlanner Velocity VelocityCommand",
    "navigation_types": "FollowerLimits NavigationError NavigationOutcome NavigatorLimits NavigatorState Result Tick",
    "navigator": "Navigator",
    "patience": "PatienceClock",
    "recovery_behaviors": "ClearCostmap RecoveryBehavior RecoveryStep RotateRecovery default_recoveries",
}

_MODULES = {name: module for module, names in _NAMES.items() for name in names.split()}
__all__ = [*_MODULES]
__getattr__ = loader(__name__, _MODULES)
