"""Settings of the move_base node, read from its parameters."""

import contextlib
import math
from typing import Tuple

import rospy
import yaml

from rosoclingo.common.parameters import Parameters
from rosoclingo.common.reading import Reader
from rosoclingo.robot.navigation.costmap import CostmapLimits
from rosoclingo.robot.navigation.local_planner import inscribed_radius, path_radii
from rosoclingo.robot.navigation.navigation_types import NavigatorLimits
from rosoclingo.robot.nodes.move_base.plugins import global_planner_namespace

# Default names of the layers, and the endings of their types. The types identify layers with other names.
LAYERS = {
    "static_layer": ("StaticLayer",),
    "obstacle_layer": ("ObstacleLayer", "VoxelLayer"),
    "inflation_layer": ("InflationLayer",),
}

DATA_TYPE = "LaserScan"  # the only supported data type of an observation source


class Settings:
    """All settings of the node; faults are collected in ``given``.

    Periods and ages are in s, lengths in m. Pairs are for the global and the local costmap.
    """

    def __init__(self, given: Parameters) -> None:
        radius, self.footprint = _body(given)
        in_layer = _Layers(given)
        sources = in_layer("obstacle_layer", "observation_sources").text("base_scan", empty=True).split()
        if len(sources) > 1:
            rospy.logwarn("only the first of the observation sources %s is used", ", ".join(sources))
        source = sources[0] if sources else "base_scan"
        kind = in_layer("obstacle_layer", source + "/data_type")
        kind.read(f"{DATA_TYPE}, the only supported type", lambda got: got if got == DATA_TYPE else None, DATA_TYPE)
        whole, local = given.group("global_costmap"), given.group("local_costmap")
        self.map_frame = whole("global_frame").text("map").lstrip("/")
        self.base_frame = whole("robot_base_frame").text("base_link").lstrip("/")
        self.local_frame = local("global_frame").text("").lstrip("/")  # empty: the frame of the odometry
        self.transform_tolerance = whole("transform_tolerance").number(0.5, low=0.0)
        self.obstacles = in_layer("obstacle_layer", "enabled").flag(True) and bool(sources)
        self.scan_topic = in_layer("obstacle_layer", source + "/topic").text(source)
        self.scan_timeout = in_layer("obstacle_layer", source + "/expected_update_rate").number(1.0, low=0.0)
        self.map_topic = in_layer("static_layer", "map_topic").text("map")
        self.costmap = _costmap(given, in_layer, radius, path_radii(radius, self.footprint))
        self.navigator = _navigator(given)
        self.controller_period = 1.0 / given.at("controller_frequency").number(20.0, above=0.0)
        self.publish_periods = _period(whole("publish_frequency"), 0.0), _period(local("publish_frequency"), 2.0)
        self.update_periods = _period(whole("update_frequency"), 5.0), _period(local("update_frequency"), 5.0)
        self.send_full = tuple(group("always_send_full_costmap").flag(False) for group in (whole, local))
        self.local_size = local("width").number(6.0, above=0.0), local("height").number(6.0, above=0.0)
        self.rest_when_idle = given.at("shutdown_costmaps").flag(False)


class _Layers:
    """Finds the parameters of a layer under the name that ``plugins`` gives it.

    If the namespace of the layer lacks a parameter, the namespace of the costmap is searched. Configurations from
    before the introduction of layers have it there.
    """

    def __init__(self, given: Parameters) -> None:
        self._given = given
        self._names = {usual: usual for usual in LAYERS}
        for plugin in given.at("global_costmap/plugins").items("a list of layers"):
            plugin.mapping("a mapping with name and type")
            name, kind = plugin.at("name").text(), plugin.at("type").text()
            self._names.update({usual: name for usual, ends in LAYERS.items() if kind.endswith(ends)})

    def __call__(self, usual: str, key: str) -> Reader:
        """Return a parameter of a layer, by the default name of the layer."""
        in_layer, own = f"global_costmap/{self._names[usual]}/{key}", f"global_costmap/{key}"
        return self._given.at(own if self._given.has(own) and not self._given.has(in_layer) else in_layer)


def _costmap(given: Parameters, in_layer: _Layers, radius: float, ways: Tuple[float, ...]) -> CostmapLimits:
    base = CostmapLimits()
    lengths = {
        key: in_layer(layer, key).number(getattr(base, key), low=0.0)
        for layer, key in (
            ("inflation_layer", "inflation_radius"),
            ("inflation_layer", "cost_scaling_factor"),
            ("obstacle_layer", "obstacle_range"),
            ("obstacle_layer", "raytrace_range"),
            ("obstacle_layer", "static_tolerance"),
            ("obstacle_layer", "most_tolerance"),
        )
    }
    threshold = in_layer("static_layer", "lethal_cost_threshold").whole(base.lethal_threshold)
    unknown = given.at(f"{global_planner_namespace()}/allow_unknown").flag(base.allow_unknown)
    return CostmapLimits(
        robot_radius=radius, lethal_threshold=threshold, allow_unknown=unknown, path_radii=ways, **lengths
    )


def _navigator(given: Parameters) -> NavigatorLimits:
    defaults = NavigatorLimits()._asdict()
    return NavigatorLimits(**{key: given.at(key).like(default) for key, default in defaults.items()})


def _body(given: Parameters) -> Tuple[float, Tuple[Tuple[float, float], ...]]:
    """Return the planning radius, and the footprint, which is empty for a disc."""
    radius = given.at("global_costmap/robot_radius").number(CostmapLimits().robot_radius, above=0.0)
    whole, usual = given.at("global_costmap/footprint"), given.at("footprint")
    reader = usual if usual.given and not whole.given else whole
    if isinstance(reader.value, str):
        with contextlib.suppress(yaml.YAMLError):
            reader.value = yaml.safe_load(reader.value)
    faults = len(reader.faults)
    corners = [corner.numbers((2,)) for corner in reader.items("a list of corners [x, y]")]
    footprint = tuple((x, y) for x, y in corners)
    if not footprint or len(reader.faults) > faults:
        return radius, ()
    if len(footprint) < 3:
        reader.fault("needs at least three corners")
        return radius, ()
    inscribed = inscribed_radius(radius, footprint)
    if inscribed < 0.01:
        reader.fault("must contain the robot's origin, at least 0.01 m from its edges")
    return inscribed, footprint


def _period(reader: Reader, default: float) -> float:
    frequency = reader.number(default, low=0.0)
    return 1.0 / frequency if frequency > 0.0 else math.inf
