"""Plugins of the move_base node: planners and recovery behaviours, which parameters name by class path."""

import importlib
from typing import Any, Callable, Dict, List, Type

import rospy

from rosoclingo.common.parameters import ParameterError, Parameters
from rosoclingo.common.reading import Reader
from rosoclingo.robot.navigation.follower import RolloutFollower
from rosoclingo.robot.navigation.grid_planner import GlobalPlanner, GridPlanner, GridPlannerLimits
from rosoclingo.robot.navigation.local_planner import LocalPlanner
from rosoclingo.robot.navigation.navigation_types import FollowerLimits
from rosoclingo.robot.navigation.recovery_behaviors import (
    ClearCostmap,
    RecoveryBehavior,
    RotateRecovery,
    default_recoveries,
)

DEFAULT_GLOBAL = "rosoclingo.robot.navigation.grid_planner.GridPlanner"
DEFAULT_LOCAL = "rosoclingo.robot.navigation.follower.RolloutFollower"
RECOVERY = "rosoclingo.robot.navigation.recovery_behaviors."
# Replacements for plugins of the C++ navigation stack.
REPLACEMENTS = {
    "navfn/NavfnROS": DEFAULT_GLOBAL,
    "global_planner/GlobalPlanner": DEFAULT_GLOBAL,
    "carrot_planner/CarrotPlanner": DEFAULT_GLOBAL,
    "base_local_planner/TrajectoryPlannerROS": DEFAULT_LOCAL,
    "dwa_local_planner/DWAPlannerROS": DEFAULT_LOCAL,
    "clear_costmap_recovery/ClearCostmapRecovery": RECOVERY + "ClearCostmap",
    "rotate_recovery/RotateRecovery": RECOVERY + "RotateRecovery",
}
# Parameters of this package's plugins, with defaults. All other plugins check their parameters themselves.
OWN_SETTINGS: Dict[type, Dict[str, Any]] = {
    GridPlanner: GridPlannerLimits()._asdict(),
    RolloutFollower: FollowerLimits()._asdict(),
    ClearCostmap: {"reset_distance": 3.0},
    RotateRecovery: {"max_vel_theta": 1.0, "patience": 20.0},
}
# Parameters in a planner's namespace that the node reads for the costmap.
NODE_PARAMETERS = ("allow_unknown",)


def global_planner(given: Parameters) -> Callable[[], GlobalPlanner]:
    """Load the class of ``~base_global_planner``. Return a factory; faults are collected in ``given``."""
    return _planner(given, "base_global_planner", DEFAULT_GLOBAL, GlobalPlanner)


def local_planner(given: Parameters, radius: float, footprint: Any) -> Callable[[], LocalPlanner]:
    """Load the class of ``~base_local_planner`` for a robot (m). Return a factory."""
    return _planner(given, "base_local_planner", DEFAULT_LOCAL, LocalPlanner, radius, footprint)


def global_planner_namespace() -> str:
    """Return the namespace of the global planner's parameters and topics, below that of the node."""
    return _namespace(Parameters().at("base_global_planner").text(DEFAULT_GLOBAL))


def local_planner_namespace() -> str:
    """Return the namespace of the local planner's parameters and topics, below that of the node."""
    return _namespace(Parameters().at("base_local_planner").text(DEFAULT_LOCAL))


def recoveries(given: Parameters) -> Callable[[], List[RecoveryBehavior]]:
    """Load the classes of ``~recovery_behaviors``, by default those of move_base. Return a factory."""
    listed = given.at("recovery_behaviors")
    if not listed.given:
        radius = given.at("local_costmap/robot_radius").number(0.46, low=0.0)
        far = given.at("conservative_reset_dist").number(3.0, low=0.0)
        near = given.at("aggressive_reset/reset_distance").number(4.0 * radius, low=0.0)
        turns = given.at("clearing_rotation_allowed").flag(True)
        turning = _settings(given, "rotate_recovery", RotateRecovery, foreign=True)
        return lambda: default_recoveries(far, near, turns, turning)
    names: List[str] = []
    makers = [_recovery(given, item, names) for item in listed.items("a list of mappings with name and type")]
    return lambda: [make() for make in makers]


def _recovery(given: Parameters, item: Reader, names: List[str]) -> Callable[[], RecoveryBehavior]:
    item.mapping("a mapping with name and type")
    name, path = item.at("name").text(), item.at("type").text()
    if name in names:
        item.fault(f"the name {name!r} is used twice")
    names.append(name)
    kind = _load(item, path, RecoveryBehavior)
    return _maker(item, kind, name, [name, _settings(given, name, kind, path in REPLACEMENTS)])


def _planner(given: Parameters, name: str, default: str, base: type, *robot: Any) -> Callable[[], Any]:
    named_by = given.at(name)
    path = named_by.text(default)
    kind, namespace = _load(named_by, path, base), _namespace(path)
    return _maker(named_by, kind, namespace, [_settings(given, namespace, kind, path in REPLACEMENTS), *robot])


def _maker(named_by: Reader, kind: Type[Any], namespace: str, arguments: List[Any]) -> Callable[[], Any]:
    """Return a factory for a plugin. It turns any exception of the plugin into a ParameterError."""

    def make() -> Any:
        """Create the plugin."""
        try:
            return kind(*arguments)
        except Exception as error:  # noqa: BLE001 a user's class can raise any exception
            text = f"{named_by.place}: {kind.__module__}.{kind.__name__} cannot be created"
            raise ParameterError(f"{text} with the parameters ~{namespace}: {error!r}") from error

    return make


def _namespace(path: str) -> str:
    """Return the last part of a class path."""
    return path.replace("/", ".").rsplit(".", 1)[-1]


def _settings(given: Parameters, namespace: str, kind: type, foreign: bool) -> Dict[str, Any]:
    """Return the parameters of a plugin. ``foreign``: they belong to another plugin, and unknown ones are ignored."""
    reader = given.at(namespace)
    found = reader.mapping(default={})
    if kind not in OWN_SETTINGS:
        return {str(key): value for key, value in found.items() if key not in NODE_PARAMETERS}
    read = {key: reader.at(key).like(default, least=1) for key, default in OWN_SETTINGS[kind].items()}
    if not foreign:
        reader.close(also=NODE_PARAMETERS)
    return {key: value for key, value in read.items() if key in found}


def _load(named_by: Reader, path: str, base: type) -> Type[Any]:
    """Return the class of a class path; report a fault and return ``base`` if there is none."""
    if path in REPLACEMENTS:
        rospy.logwarn("%s: %s is a C++ plugin; using %s instead", named_by.place, path, REPLACEMENTS[path])
        path = REPLACEMENTS[path]
    module, _, attribute = path.rpartition(".")
    try:
        kind = getattr(importlib.import_module(module), attribute)
    except Exception as error:  # noqa: BLE001 a user's module can raise any exception
        named_by.fault(f"no class {path!r}: {error}")
        return base
    if isinstance(kind, type) and issubclass(kind, base):
        return kind
    named_by.fault(f"{path} is not a subclass of {base.__module__}.{base.__name__}")
    return base
