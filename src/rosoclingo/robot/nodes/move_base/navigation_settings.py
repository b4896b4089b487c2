"""The parameters of the move_base node: read, checked, and turned into planners and settings."""

import math
from typing import Any, Dict, NamedTuple, Tuple

import rospy
import yaml

from rosoclingo.common.parameters import ParameterError, not_negative, parameter
from rosoclingo.common.private_parameters import read_parameter
from rosoclingo.robot.navigation import CostmapLimits, NavigatorLimits
from rosoclingo.robot.navigation.local_planner import inscribed_radius, way_radii
from rosoclingo.robot.nodes.move_base.plugins import global_planner_namespace

# The layers' usual names, and what the type of each ends with where ``plugins`` lists layers of other names.
LAYERS = {
    "static_layer": ("StaticLayer",),
    "obstacle_layer": ("ObstacleLayer", "VoxelLayer"),
    "inflation_layer": ("InflationLayer",),
}


class Frames(NamedTuple):
    """Names of frames and topics, and how old (s) transforms and scans may be."""

    map: str
    base: str
    tolerance: float
    scan_topic: str
    scan_timeout: float


class Settings(NamedTuple):
    """All that the node is told by parameters.

    Pairs are for the global and the local costmap. ``local_frame`` is empty for that of odometry.
    """

    frames: Frames
    costmap: CostmapLimits
    navigator: NavigatorLimits
    controller_period: float
    footprint: Tuple[Tuple[float, float], ...]
    map_topic: str
    obstacles: bool
    publish_periods: Tuple[float, float]
    update_periods: Tuple[float, float]
    send_full: Tuple[bool, bool]
    local_size: Tuple[float, float]
    local_frame: str
    rest_when_idle: bool


def read_settings() -> Settings:
    """Read the node's parameters. Raises ParameterError."""
    radius, footprint = _body()
    sources = parameter(_layer("obstacle_layer", "observation_sources"), str, "base_scan").split()
    if len(sources) > 1:
        rospy.logwarn("of the observation sources %s only the first one is read", ", ".join(sources))
    source = sources[0] if sources else "base_scan"
    kind = parameter(_layer("obstacle_layer", source + "/data_type"), str, "LaserScan")
    if kind != "LaserScan":
        raise ParameterError(f"the observation source {source!r} must have the data_type LaserScan, not {kind!r}")
    return Settings(
        Frames(
            parameter("~global_costmap/global_frame", str, "map").lstrip("/"),
            parameter("~global_costmap/robot_base_frame", str, "base_link").lstrip("/"),
            not_negative("~global_costmap/transform_tolerance", 0.5),
            parameter(_layer("obstacle_layer", source + "/topic"), str, source),
            not_negative(_layer("obstacle_layer", source + "/expected_update_rate"), 1.0),
        ),
        _costmap(radius, way_radii(radius, footprint)),
        _navigator(),
        1.0 / _positive("~controller_frequency", 20.0),
        footprint,
        parameter(_layer("static_layer", "map_topic"), str, "map"),
        bool(sources) and parameter(_layer("obstacle_layer", "enabled"), bool, True),
        (_period("~global_costmap/publish_frequency", 0.0), _period("~local_costmap/publish_frequency", 2.0)),
        (_period("~global_costmap/update_frequency", 5.0), _period("~local_costmap/update_frequency", 5.0)),
        (
            parameter("~global_costmap/always_send_full_costmap", bool, False),
            parameter("~local_costmap/always_send_full_costmap", bool, False),
        ),
        (_positive("~local_costmap/width", 6.0), _positive("~local_costmap/height", 6.0)),
        parameter("~local_costmap/global_frame", str, "").lstrip("/"),
        parameter("~shutdown_costmaps", bool, False),
    )


def _layer(usual: str, key: str) -> str:
    """Return the name of a parameter of a layer, whatever ``plugins`` calls the layer.

    What the layer's namespace lacks may be in the costmap's own, where configurations older than layers have it.
    """
    layer = usual
    for plugin in parameter("~global_costmap/plugins", list, []):
        fit = isinstance(plugin, dict) and str(plugin.get("type", "")).endswith(LAYERS[usual])
        if fit and isinstance(plugin.get("name"), str):
            layer = plugin["name"]
    names = (f"~global_costmap/{layer}/{key}", f"~global_costmap/{key}")
    return names[1] if not rospy.has_param(names[0]) and rospy.has_param(names[1]) else names[0]


def _costmap(radius: float, ways: Tuple[float, ...]) -> CostmapLimits:
    base = CostmapLimits()
    lengths = {
        key: not_negative(_layer(layer, key), getattr(base, key))
        for layer, key in (
            ("inflation_layer", "inflation_radius"),
            ("inflation_layer", "cost_scaling_factor"),
            ("obstacle_layer", "obstacle_range"),
            ("obstacle_layer", "raytrace_range"),
            ("obstacle_layer", "static_tolerance"),
            ("obstacle_layer", "most_tolerance"),
        )
    }
    threshold = parameter(_layer("static_layer", "lethal_cost_threshold"), int, base.lethal_threshold)
    unknown = parameter(f"~{global_planner_namespace()}/allow_unknown", bool, base.allow_unknown)
    return CostmapLimits(
        robot_radius=radius, lethal_threshold=threshold, allow_unknown=unknown, way_radii=ways, **lengths
    )


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
    text = read_parameter("~global_costmap/footprint", read_parameter("~footprint", []))
    try:
        corners = yaml.safe_load(text) if isinstance(text, str) else text
        footprint = tuple((float(x), float(y)) for x, y in (corners or []))
        if not all(math.isfinite(x) and math.isfinite(y) for x, y in footprint):
            raise ValueError("a corner is not finite")
    except (ValueError, TypeError, yaml.YAMLError) as error:
        raise ParameterError(f"~global_costmap/footprint must be a list of [x, y], is {text!r}") from error
    radius = _positive("~global_costmap/robot_radius", CostmapLimits().robot_radius)
    if not footprint:
        return radius, ()
    if len(footprint) < 3:
        raise ParameterError("~global_costmap/footprint needs three corners or more")
    inscribed = inscribed_radius(radius, footprint)
    if inscribed < 0.01:
        raise ParameterError("~global_costmap/footprint must have the robot's origin well within it")
    return inscribed, footprint


def _positive(name: str, default: float) -> float:
    value = not_negative(name, default)
    if value == 0.0:
        raise ParameterError(f"parameter {rospy.resolve_name(name)} must be more than 0")
    return value


def _period(name: str, default: float) -> float:
    frequency = not_negative(name, default)
    return 1.0 / frequency if frequency > 0.0 else math.inf
