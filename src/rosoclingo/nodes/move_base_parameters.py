"""The parameters of the move_base node: read, checked, and turned into planners and settings."""

import importlib
import math
from typing import Any, Dict, List, NamedTuple, Tuple, Type

import rospy
import yaml

from rosoclingo.navigation import (
    ClearCostmap,
    CostmapLimits,
    FollowerLimits,
    GlobalPlanner,
    GridPlannerLimits,
    LocalPlanner,
    NavigatorLimits,
    RecoveryBehavior,
    default_recoveries,
)
from rosoclingo.navigation.local_planner import inscribed_radius
from rosoclingo.nodes.parameters import ParameterError, not_negative, parameter

# Plugins of the C++ navigation stack that configurations name, and what stands in for them here.
STANDINS = {
    "navfn/NavfnROS": "rosoclingo.navigation.planner.GridPlanner",
    "global_planner/GlobalPlanner": "rosoclingo.navigation.planner.GridPlanner",
    "carrot_planner/CarrotPlanner": "rosoclingo.navigation.planner.GridPlanner",
    "base_local_planner/TrajectoryPlannerROS": "rosoclingo.navigation.follower.RolloutFollower",
    "dwa_local_planner/DWAPlannerROS": "rosoclingo.navigation.follower.RolloutFollower",
    "clear_costmap_recovery/ClearCostmapRecovery": "rosoclingo.navigation.recovery.ClearCostmap",
    "rotate_recovery/RotateRecovery": "rosoclingo.navigation.recovery.RotateRecovery",
}
DEFAULT_GLOBAL = "rosoclingo.navigation.planner.GridPlanner"
DEFAULT_LOCAL = "rosoclingo.navigation.follower.RolloutFollower"


class Frames(NamedTuple):
    """Names of frames and topics, and how old (s) transforms and scans may be."""

    map: str
    base: str
    tolerance: float
    scan_topic: str
    scan_timeout: float


class Settings(NamedTuple):
    """All that the node is told by parameters."""

    frames: Frames
    costmap: CostmapLimits
    navigator: NavigatorLimits
    controller_period: float
    footprint: Tuple[Tuple[float, float], ...]
    map_topic: str
    obstacles: bool
    publish_periods: Tuple[float, float]
    local_size: Tuple[float, float]
    shutdown_clears: bool


def read_settings() -> Settings:
    """Read the node's parameters. Raises ParameterError."""
    radius, footprint = _body()
    layer = "~global_costmap/obstacle_layer/"
    sources = parameter(layer + "observation_sources", str, "base_scan").split()
    source = layer + (sources[0] if sources else "base_scan") + "/"
    return Settings(
        Frames(
            parameter("~global_costmap/global_frame", str, "map").lstrip("/"),
            parameter("~global_costmap/robot_base_frame", str, "base_link").lstrip("/"),
            not_negative("~global_costmap/transform_tolerance", 0.5),
            parameter(source + "topic", str, "base_scan"),
            not_negative(source + "expected_update_rate", 1.0),
        ),
        _costmap(layer, radius),
        _navigator(),
        1.0 / _positive("~controller_frequency", 20.0),
        footprint,
        parameter("~global_costmap/static_layer/map_topic", str, "map"),
        bool(sources) and parameter(layer + "enabled", bool, True),
        tuple(_period(f"~{n}_costmap/publish_frequency", d) for n, d in (("global", 0.0), ("local", 2.0))),  # type: ignore[arg-type]
        (_positive("~local_costmap/width", 6.0), _positive("~local_costmap/height", 6.0)),
        parameter("~shutdown_costmaps", bool, False),
    )


def make_global_planner() -> GlobalPlanner:
    """Make the planner that ``~base_global_planner`` names. Raises ParameterError."""
    kind, name, known = _plugin("~base_global_planner", DEFAULT_GLOBAL, GlobalPlanner)
    return kind(_own_settings(name, GridPlannerLimits._fields, known))  # type: ignore[no-any-return]


def make_local_planner(settings: Settings) -> LocalPlanner:
    """Make the planner that ``~base_local_planner`` names. Raises ParameterError."""
    kind, name, known = _plugin("~base_local_planner", DEFAULT_LOCAL, LocalPlanner)
    own = _own_settings(name, FollowerLimits._fields, known)
    return kind(own, settings.costmap.robot_radius, settings.footprint)  # type: ignore[no-any-return]


def plugin_namespace(name: str, default: str) -> str:
    """Return the namespace of a plugin's parameters and topics: the last part of its class path."""
    return parameter(name, str, default).replace("/", ".").rsplit(".", 1)[-1]


def make_recoveries() -> List[RecoveryBehavior]:
    """Make the behaviours that ``~recovery_behaviors`` lists, else move_base's own. Raises ParameterError."""
    listed = rospy.get_param("~recovery_behaviors", None)
    if listed is None:
        radius = not_negative("~local_costmap/robot_radius", 0.46)
        return default_recoveries(
            not_negative("~conservative_reset_dist", 3.0),
            not_negative("~aggressive_reset/reset_distance", 4.0 * radius),
            parameter("~clearing_rotation_allowed", bool, True),
        )
    if not isinstance(listed, list):
        raise ParameterError("parameter {} must be a list".format(rospy.resolve_name("~recovery_behaviors")))
    return [_recovery(item) for item in listed]


def _recovery(item: Any) -> RecoveryBehavior:
    if not isinstance(item, dict) or not isinstance(item.get("name"), str) or not isinstance(item.get("type"), str):
        raise ParameterError(f"~recovery_behaviors: each entry needs a name and a type, not {item!r}")
    kind = _load("~recovery_behaviors", item["type"], RecoveryBehavior)
    own = parameter("~" + item["name"], dict, {})
    if kind is ClearCostmap and not isinstance(own.get("reset_distance", 3.0), (int, float)):
        raise ParameterError("~{}/reset_distance must be a number".format(item["name"]))
    return kind(item["name"], own)  # type: ignore[no-any-return]


def _plugin(name: str, default: str, base: type) -> Tuple[Type[Any], str, bool]:
    """Return a plugin's class, the namespace of its parameters, and whether it stands in for another."""
    path = parameter(name, str, default)
    return _load(name, path, base), plugin_namespace(name, default), path in STANDINS


def _load(name: str, path: str, base: type) -> Type[Any]:
    """Return the class of a class path. Raises ParameterError."""
    if path in STANDINS:
        rospy.logwarn("%s: %s is a C++ plugin; %s stands in for it", rospy.resolve_name(name), path, STANDINS[path])
        path = STANDINS[path]
    module, _, attribute = path.rpartition(".")
    try:
        kind = getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, ValueError) as error:
        raise ParameterError(f"{rospy.resolve_name(name)}: no class {path!r}: {error}") from error
    if not (isinstance(kind, type) and issubclass(kind, base)):
        raise ParameterError(f"{rospy.resolve_name(name)}: {path} is no {base.__name__}")
    return kind


def _own_settings(namespace: str, fields: Tuple[str, ...], stands_in: bool) -> Dict[str, Any]:
    """Return the parameters in a plugin's namespace; a stand-in takes those that it knows."""
    own = parameter("~" + namespace, dict, {})
    if stands_in:
        return {key: value for key, value in own.items() if key in fields}
    return own


def _costmap(layer: str, radius: float) -> CostmapLimits:
    base = CostmapLimits()
    inflation = "~global_costmap/inflation_layer/"
    return CostmapLimits(
        robot_radius=radius,
        inflation_radius=not_negative(inflation + "inflation_radius", base.inflation_radius),
        cost_scaling_factor=not_negative(inflation + "cost_scaling_factor", base.cost_scaling_factor),
        obstacle_range=not_negative(layer + "obstacle_range", base.obstacle_range),
        raytrace_range=not_negative(layer + "raytrace_range", base.raytrace_range),
        static_tolerance=not_negative(layer + "static_tolerance", base.static_tolerance),
        lethal_threshold=int(
            parameter("~global_costmap/static_layer/lethal_cost_threshold", int, base.lethal_threshold)
        ),
        allow_unknown=bool(parameter(f"~{_global_namespace()}/allow_unknown", bool, base.allow_unknown)),
    )


def _global_namespace() -> str:
    return plugin_namespace("~base_global_planner", DEFAULT_GLOBAL)


def _navigator() -> NavigatorLimits:
    values: Dict[str, Any] = {}
    for key, default in zip(NavigatorLimits._fields, NavigatorLimits()):
        kind = type(default)
        values[key] = parameter("~" + key, kind, default)
        if kind is float and not 0.0 <= values[key] < math.inf:
            raise ParameterError("parameter {} must be 0 or more".format(rospy.resolve_name("~" + key)))
    return NavigatorLimits(**values)


def _body() -> Tuple[float, Tuple[Tuple[float, float], ...]]:
    """Return the radius to plan with and the footprint, empty for a disc."""
    text = rospy.get_param("~global_costmap/footprint", rospy.get_param("~footprint", []))
    try:
        corners = yaml.safe_load(text) if isinstance(text, str) else text
        footprint = tuple((float(x), float(y)) for x, y in (corners or []))
    except (ValueError, TypeError, yaml.YAMLError) as error:
        raise ParameterError(f"~global_costmap/footprint must be a list of [x, y], is {text!r}") from error
    radius = _positive("~global_costmap/robot_radius", CostmapLimits().robot_radius)
    if not footprint:
        return radius, ()
    if len(footprint) < 3:
        raise ParameterError("~global_costmap/footprint needs three corners or more")
    return inscribed_radius(radius, footprint), footprint


def _positive(name: str, default: float) -> float:
    value = not_negative(name, default)
    if value == 0.0:
        raise ParameterError(f"parameter {rospy.resolve_name(name)} must be more than 0")
    return value


def _period(name: str, default: float) -> float:
    frequency = not_negative(name, default)
    return 1.0 / frequency if frequency > 0.0 else math.inf
