"""The planners and recovery behaviours of the move_base node, which parameters name by class path."""

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
# Plugins of the C++ navigation stack that configurations name, and what stands in for them here.
STANDINS = {
    "navfn/NavfnROS": DEFAULT_GLOBAL,
    "global_planner/GlobalPlanner": DEFAULT_GLOBAL,
    "carrot_planner/CarrotPlanner": DEFAULT_GLOBAL,
    "base_local_planner/TrajectoryPlannerROS": DEFAULT_LOCAL,
    "dwa_local_planner/DWAPlannerROS": DEFAULT_LOCAL,
    "clear_costmap_recovery/ClearCostmapRecovery": RECOVERY + "ClearCostmap",
    "rotate_recovery/RotateRecovery": RECOVERY + "RotateRecovery",
}
# What this package's own plugins take: names and kinds of values. Any other plugin checks its parameters itself.
OWN_SETTINGS: Dict[type, Dict[str, Any]] = {
    GridPlanner: GridPlannerLimits()._asdict(),
    RolloutFollower: FollowerLimits()._asdict(),
    ClearCostmap: {"reset_distance": 3.0},
    RotateRecovery: {"max_vel_theta": 1.0, "patience": 20.0},
}
# Read from a planner's namespace by the node itself, as the costmap needs to know.
OF_THE_NODE = ("allow_unknown",)


def global_planner(given: Parameters) -> Callable[[], GlobalPlanner]:
    """Find the planner that ``~base_global_planner`` names; return what makes it. The parameters have the faults."""
    return _planner(given, "base_global_planner", DEFAULT_GLOBAL, GlobalPlanner)


def local_planner(given: Parameters, radius: float, footprint: Any) -> Callable[[], LocalPlanner]:
    """Find the planner that ``~base_local_planner`` names, for a robot (m); return what makes it."""
    return _planner(given, "base_local_planner", DEFAULT_LOCAL, LocalPlanner, radius, footprint)


def global_planner_namespace() -> str:
    """Return where the global planner's parameters and topics are, below the node's own."""
    return _namespace(Parameters().at("base_global_planner").text(DEFAULT_GLOBAL))


def local_planner_namespace() -> str:
    """Return where the local planner's parameters and topics are, below the node's own."""
    return _namespace(Parameters().at("base_local_planner").text(DEFAULT_LOCAL))


def recoveries(given: Parameters) -> Callable[[], List[RecoveryBehavior]]:
    """Find the behaviours that ``~recovery_behaviors`` lists, else move_base's own; return what makes them."""
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
        item.fault(f"the name {name!r} is there twice")
    names.append(name)
    kind = _load(item, path, RecoveryBehavior)
    return _maker(item, kind, name, [name, _settings(given, name, kind, path in STANDINS)])


def _planner(given: Parameters, name: str, default: str, base: type, *robot: Any) -> Callable[[], Any]:
    named_by = given.at(name)
    path = named_by.text(default)
    kind, namespace = _load(named_by, path, base), _namespace(path)
    return _maker(named_by, kind, namespace, [_settings(given, namespace, kind, path in STANDINS), *robot])


def _maker(named_by: Reader, kind: Type[Any], namespace: str, arguments: List[Any]) -> Callable[[], Any]:
    """Return what makes a plugin; it raises ParameterError whatever goes wrong, as the plugin may be anybody's."""

    def make() -> Any:
        """Make the plugin."""
        try:
            return kind(*arguments)
        except Exception as error:  # noqa: BLE001 a user's class may raise anything
            text = f"{named_by.place}: {kind.__module__}.{kind.__name__} cannot be made"
            raise ParameterError(f"{text} with the parameters ~{namespace}: {error!r}") from error

    return make


def _namespace(path: str) -> str:
    """Return the last part of a class path."""
    return path.replace("/", ".").rsplit(".", 1)[-1]


def _settings(given: Parameters, namespace: str, kind: type, foreign: bool) -> Dict[str, Any]:
    """Return the parameters of a plugin; ``foreign`` ones were made for another, which has some of its own."""
    reader = given.at(namespace)
    found = reader.mapping(default={})
    if kind not in OWN_SETTINGS:
        return {str(key): value for key, value in found.items() if key not in OF_THE_NODE}
    read = {key: reader.at(key).like(default, least=1) for key, default in OWN_SETTINGS[kind].items()}
    if not foreign:
        reader.close(also=OF_THE_NODE)
    return {key: value for key, value in read.items() if key in found}


def _load(named_by: Reader, path: str, base: type) -> Type[Any]:
    """Return the class of a class path; the base where there is none such, which is a fault."""
    if path in STANDINS:
        rospy.logwarn("%s: %s is a C++ plugin; %s stands in for it", named_by.place, path, STANDINS[path])
        path = STANDINS[path]
    module, _, attribute = path.rpartition(".")
    try:
        kind = getattr(importlib.import_module(module), attribute)
    except Exception as error:  # noqa: BLE001 a user's module may raise anything
        named_by.fault(f"no class {path!r}: {error}")
        return base
    if isinstance(kind, type) and issubclass(kind, base):
        return kind
    named_by.fault(f"{path} is no subclass of {base.__module__}.{base.__name__}")
    return base
