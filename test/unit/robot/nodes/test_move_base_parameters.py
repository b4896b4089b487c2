"""Every parameter of the move_base node: read under its own name, and refused by name when it is invalid."""

from pathlib import Path

import pytest
import yaml

from rosoclingo.common import parameters
from rosoclingo.common.parameters import ParameterError, Parameters, unread
from rosoclingo.robot.navigation import (
    ClearCostmap,
    FollowerLimits,
    GlobalPlanner,
    GridPlannerLimits,
    LocalPlanner,
    NavigatorLimits,
    RotateRecovery,
)
from rosoclingo.robot.nodes.move_base import plugins
from rosoclingo.robot.nodes.move_base.navigation_settings import Settings

rospy = pytest.importorskip("rospy")
ROOT = Path(__file__).resolve().parents[4]
SQUARE = [[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]]


class OwnLocalPlanner(LocalPlanner):
    """A user's planner."""


class Broken(GlobalPlanner):
    """A user's planner whose construction fails."""

    def __init__(self, parameters=None):
        raise KeyError("horizon")


@pytest.fixture
def given(monkeypatch):
    """Sets the node's parameters, nested as in a YAML file or with slashes in their names."""

    def give(values=None, **more):
        nested = {}
        for name, value in {**(values or {}), **more}.items():
            *path, last = name.split("/")
            place = nested
            for part in path:
                place = place.setdefault(part, {})
            place[last] = value
        monkeypatch.setattr(rospy, "get_param", lambda name, default=None: nested if name == "~" else default)
        monkeypatch.setattr(parameters, "_READ", set())

    return give


def settings_of():
    """Return the settings that the node reads; raises ParameterError with all faults."""
    found = Parameters()
    settings = Settings(found)
    found.check()
    return settings


def made(find, *arguments):
    """Return the plugins that the parameters name; raises ParameterError with all faults."""
    found = Parameters()
    make = find(found, *arguments)
    found.check()
    return make()


SETTINGS = [
    ("controller_frequency", 10, lambda s: s.controller_period, 0.1),
    ("planner_frequency", 2, lambda s: s.navigator.planner_frequency, 2.0),
    ("planner_patience", 1.5, lambda s: s.navigator.planner_patience, 1.5),
    ("controller_patience", 2.5, lambda s: s.navigator.controller_patience, 2.5),
    ("max_planning_retries", 3, lambda s: s.navigator.max_planning_retries, 3),
    ("oscillation_timeout", 7.0, lambda s: s.navigator.oscillation_timeout, 7.0),
    ("oscillation_distance", 0.25, lambda s: s.navigator.oscillation_distance, 0.25),
    ("progress_timeout", 9, lambda s: s.navigator.progress_timeout, 9.0),
    ("recovery_behavior_enabled", False, lambda s: s.navigator.recovery_behavior_enabled, False),
    ("shutdown_costmaps", True, lambda s: s.rest_when_idle, True),
    ("global_costmap/global_frame", "/world", lambda s: s.map_frame, "world"),
    ("global_costmap/robot_base_frame", "robot_0/base_link", lambda s: s.base_frame, "robot_0/base_link"),
    ("global_costmap/transform_tolerance", 1, lambda s: s.transform_tolerance, 1.0),
    ("global_costmap/robot_radius", 0.3, lambda s: s.costmap.robot_radius, 0.3),
    ("global_costmap/publish_frequency", 4.0, lambda s: s.publish_periods[0], 0.25),
    ("global_costmap/update_frequency", 2.0, lambda s: s.update_periods[0], 0.5),
    ("global_costmap/always_send_full_costmap", True, lambda s: s.send_full, (True, False)),
    ("global_costmap/static_layer/map_topic", "/floor", lambda s: s.map_topic, "/floor"),
    ("global_costmap/static_layer/lethal_cost_threshold", 65, lambda s: s.costmap.lethal_threshold, 65),
    ("global_costmap/inflation_layer/inflation_radius", 0.7, lambda s: s.costmap.inflation_radius, 0.7),
    ("global_costmap/inflation_layer/cost_scaling_factor", 3.0, lambda s: s.costmap.cost_scaling_factor, 3.0),
    ("global_costmap/obstacle_layer/enabled", False, lambda s: s.obstacles, False),
    ("global_costmap/obstacle_layer/observation_sources", "", lambda s: s.obstacles, False),
    ("global_costmap/obstacle_layer/observation_sources", "front rear", lambda s: s.scan_topic, "front"),
    ("global_costmap/obstacle_layer/obstacle_range", 2.5, lambda s: s.costmap.obstacle_range, 2.5),
    ("global_costmap/obstacle_layer/raytrace_range", 3.0, lambda s: s.costmap.raytrace_range, 3.0),
    ("global_costmap/obstacle_layer/static_tolerance", 0.0, lambda s: s.costmap.static_tolerance, 0.0),
    ("global_costmap/obstacle_layer/most_tolerance", 0.2, lambda s: s.costmap.most_tolerance, 0.2),
    ("global_costmap/obstacle_layer/base_scan/topic", "scan", lambda s: s.scan_topic, "scan"),
    ("global_costmap/obstacle_layer/base_scan/expected_update_rate", 0.4, lambda s: s.scan_timeout, 0.4),
    ("local_costmap/publish_frequency", 0.0, lambda s: s.publish_periods[1], float("inf")),
    ("local_costmap/update_frequency", 4, lambda s: s.update_periods[1], 0.25),
    ("local_costmap/always_send_full_costmap", True, lambda s: s.send_full, (False, True)),
    ("local_costmap/width", 4, lambda s: s.local_size, (4.0, 6.0)),
    ("local_costmap/height", 3.5, lambda s: s.local_size, (6.0, 3.5)),
    ("local_costmap/global_frame", "odom_combined", lambda s: s.local_frame, "odom_combined"),
    ("GridPlanner/allow_unknown", True, lambda s: s.costmap.allow_unknown, True),
]


def test_move_base_parameters_are_each_read_and_documented(given):
    text = (ROOT / "doc" / "simulator_and_navigation.md").read_text()
    given()
    usual = settings_of()
    for name, value, read, expected in SETTINGS:
        assert read(usual) != expected, "the value would prove nothing"
        given({name: value})
        assert read(settings_of()) == pytest.approx(expected), name
    names = {name.split("/")[-1] for name, _, _, _ in SETTINGS} | {"patience"}
    names |= {*GridPlannerLimits._fields, *FollowerLimits._fields, *NavigatorLimits._fields}
    assert not [name for name in names if f"`{name}`" not in text and f"/{name}`" not in text]


@pytest.mark.parametrize(("name", "footprint"), [("footprint", SQUARE), ("global_costmap/footprint", str(SQUARE))])
def test_move_base_parameters_footprint_is_read(given, name, footprint):
    given({name: footprint})
    settings = settings_of()
    assert settings.footprint == tuple(map(tuple, SQUARE))
    assert settings.costmap.robot_radius == pytest.approx(0.2)


WRONG = [
    *((name, []) for name, _, _, _ in SETTINGS),
    *((name, -1.0) for name, good, _, _ in SETTINGS if isinstance(good, float)),
    ("controller_frequency", 0.0),
    ("oscillation_timeout", float("nan")),
    ("global_costmap/footprint", "[[1, 1], [2"),
    ("global_costmap/footprint", [[0.2, 0.2], [-0.2, 0.2]]),
    ("global_costmap/footprint", [[0.2, "x"], [-0.2, 0.2], [0.0, -0.2]]),
    ("global_costmap/footprint", [[0.2, float("nan")], [-0.2, 0.2], [0.0, -0.2]]),
    ("global_costmap/footprint", [[0.0, 0.2], [0.0, -0.2], [0.4, -0.2], [0.4, 0.2]]),
    ("global_costmap/plugins", "static_layer"),
    ("global_costmap/obstacle_layer/base_scan/data_type", "PointCloud2"),
]


def test_move_base_parameters_layers_can_have_other_names(given):
    layers = [
        {"name": "walls", "type": "costmap_2d::StaticLayer"},
        {"name": "obstacles", "type": "costmap_2d::VoxelLayer"},
        {"name": "fear", "type": "costmap_2d::InflationLayer"},
    ]
    given(
        {
            "global_costmap/plugins": layers,
            "global_costmap/walls/map_topic": "floor",
            "global_costmap/obstacles/obstacle_range": 2.0,
            "global_costmap/obstacles/observation_sources": "laser",
            "global_costmap/obstacles/laser/topic": "/scan",
            "global_costmap/fear/inflation_radius": 0.8,
        }
    )
    settings = settings_of()
    assert (settings.map_topic, settings.scan_topic) == ("floor", "/scan")
    assert (settings.costmap.obstacle_range, settings.costmap.inflation_radius) == (2.0, 0.8)


def test_move_base_parameters_refuse_wrong_values_by_name(given):
    for name, value in WRONG:
        given({name: value})
        with pytest.raises(ParameterError, match=name.split("/")[-1]):
            settings_of()


def test_move_base_parameters_navigation_stack_names_are_mapped(given):
    given(
        base_global_planner="navfn/NavfnROS",
        base_local_planner="dwa_local_planner/DWAPlannerROS",
        recovery_behaviors=[
            {"name": "reset", "type": "clear_costmap_recovery/ClearCostmapRecovery"},
            {"name": "turn", "type": "rotate_recovery/RotateRecovery"},
        ],
        NavfnROS={"visualize_potential": True, "default_tolerance": 0.5, "allow_unknown": True},
        DWAPlannerROS={"max_vel_x": 0.3, "path_distance_bias": 32.0},
        reset={"reset_distance": 2.0, "layer_names": ["obstacles"]},
    )
    assert made(plugins.global_planner).limits.default_tolerance == 0.5
    assert made(plugins.local_planner, 0.2, ()).limits.max_vel_x == 0.3
    reset, turn = made(plugins.recoveries)
    assert (type(reset), reset.parameters) == (ClearCostmap, {"reset_distance": 2.0})
    assert type(turn) is RotateRecovery
    assert settings_of().costmap.allow_unknown
    assert plugins.global_planner_namespace() == "NavfnROS"


RESET = {"name": "reset", "type": "rosoclingo.robot.navigation.recovery_behaviors.ClearCostmap"}


def test_move_base_parameters_recoveries_without_turning(given):
    given(clearing_rotation_allowed=False, conservative_reset_dist=2.0, aggressive_reset={"reset_distance": 1.0})
    first, second = made(plugins.recoveries)
    assert (first.parameters["reset_distance"], second.parameters["reset_distance"]) == (2.0, 1.0)


def test_move_base_parameters_of_shipped_file_are_read(given):
    values = yaml.safe_load((ROOT / "config" / "navigation.yaml").read_text())
    given(values)
    settings = settings_of()
    made(plugins.global_planner)
    made(plugins.local_planner, settings.costmap.robot_radius, settings.footprint)
    made(plugins.recoveries)

    assert unread(values, parameters._READ) == []


GLOBAL, LOCAL, RECOVERIES = (plugins.global_planner,), (plugins.local_planner, 0.2, ()), (plugins.recoveries,)


@pytest.mark.parametrize(
    ("parts", "values", "words"),
    [
        (GLOBAL, {"base_global_planner": "no.such.Planner"}, "~base_global_planner: no class 'no.such.Planner'"),
        (GLOBAL, {"base_global_planner": f"{__name__}.OwnLocalPlanner"}, "is not a subclass of .*GlobalPlanner"),
        (GLOBAL, {"base_global_planner": f"{__name__}.Broken"}, "Broken cannot be created with the parameters ~Broken"),
        (GLOBAL, {"GridPlanner": {"speed": 1}}, "~GridPlanner: unknown key 'speed'; keys are comfort_weight, "),
        (GLOBAL, {"GridPlanner": {"spacing": -0.1}}, "~GridPlanner/spacing: must be a number of at least 0, not -0.1"),
        (RECOVERIES, {"recovery_behaviors": [{"name": "reset"}]}, r"~recovery_behaviors\[0\]/type: is missing"),
        (RECOVERIES, {"recovery_behaviors": [RESET, RESET]}, "the name 'reset' is used twice"),
        (
            RECOVERIES,
            {"recovery_behaviors": [RESET], "reset": {"reset_distance": "far"}},
            "~reset/reset_distance: must",
        ),
    ],
)
def test_move_base_parameters_refuse_a_wrong_plugin(given, parts, values, words):
    given(values)
    with pytest.raises(ParameterError, match=words):
        made(*parts)
