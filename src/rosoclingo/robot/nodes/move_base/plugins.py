"""The planners and recovery behaviours of the move_base node, which parameters name by class path."""

import importlib
import time
from typing import Any, Dict, List, NamedTuple, Type

import rospy

from rosoclingo.common.parameters import ParameterError, not_negative, parameter
from rosoclingo.common.private_parameters import read_parameter
from rosoclingo.robot.navigation import (
    ClearCostmap,
    Costmap,
    FollowerLimits,
    GlobalPlanner,
    GridPlanner,
    GridPlannerLimits,
    LocalPlanner,
    RecoveryBehavior,
    RolloutFollower,
    RotateRecovery,
    default_recoveries,
)

# Plugins of the C++ navigation stack that configurations name, and what stands in for them here.
STANDINS = {
    "navfn/NavfnROS": "rosoclingo.robot.navigation.grid_planner.GridPlanner",
    "global_planner/GlobalPlanner": "rosoclingo.robot.navigation.grid_planner.GridPlanner",
    "carrot_planner/CarrotPlanner": "rosoclingo.robot.navigation.grid_planner.GridPlanner",
    "base_local_planner/TrajectoryPlannerROS": "rosoclingo.robot.navigation.follower.RolloutFollower",
    "dwa_local_planner/DWAPlannerROS": "rosoclingo.robot.navigation.follower.RolloutFollower",
    "clear_costmap_recovery/ClearCostmapRecovery": "rosoclingo.robot.navigation.recovery_behaviors.ClearCostmap",
    "rotate_recovery/RotateRecovery": "rosoclingo.robot.navigation.recovery_behaviors.RotateRecovery",
}
# Where these were before; configurations may name them so.
MOVED = {
    "rosoclingo.navigation.planner.GridPlanner": "rosoclingo.robot.navigation.grid_planner.GridPlanner",
    "rosoclingo.navigation.follower.RolloutFollower": "rosoclingo.robot.navigation.follower.RolloutFollower",
    "rosoclingo.navigation.recovery.ClearCostmap": "rosoclingo.robot.navigation.recovery_behaviors.ClearCostmap",
    "rosoclingo.navigation.recovery.RotateRecovery": "rosoclingo.robot.navigation.recovery_behaviors.RotateRecovery",
}
DEFAULT_GLOBAL = "rosoclingo.robot.navigation.grid_planner.GridPlanner"
DEFAULT_LOCAL = "rosoclingo.robot.navigation.follower.RolloutFollower"
# What this package's own plugins take: names and kinds of values. Any other plugin checks its parameters itself.
OWN_SETTINGS: Dict[type, Dict[str, Any]] = {
    GridPlanner: GridPlannerLimits()._asdict(),
    RolloutFollower: FollowerLimits()._asdict(),
    ClearCostmap: {"reset_distance": 3.0},
    RotateRecovery: {"max_vel_theta": 1.0, "patience": 20.0},
}
# Read from a planner's namespace by the node itself, as the costmap needs to know.
OF_THE_NODE = ("allow_unknown",)
PREPARATION = 2.0  # s that a start lasts longer for: what is left to prepare then is done beside all else


class _Plugin(NamedTuple):
    """A plugin's class, where its parameters are, the parameters, and the parameter that names it."""

    kind: Type[Any]
    namespace: str
    settings: Dict[str, Any]
    named_by: str

    def make(self, *arguments: Any) -> Any:
        """Make the plugin. Raises ParameterError whatever goes wrong in it: it may be anybody's."""
        try:
            return self.kind(*arguments)
        except Exception as error:  # noqa: BLE001 a user's class may raise anything
            text = f"{self.named_by}: {self.kind.__module__}.{self.kind.__name__} cannot be made"
            raise ParameterError(f"{text} with the parameters ~{self.namespace}: {error!r}") from error


def make_global_planner() -> GlobalPlanner:
    """Make the planner that ``~base_global_planner`` names. Raises ParameterError."""
    plugin = _planner("~base_global_planner", DEFAULT_GLOBAL, GlobalPlanner)
    return plugin.make(plugin.settings)  # type: ignore[no-any-return]


def make_local_planner(radius: float, footprint: Any) -> LocalPlanner:
    """Make the planner that ``~base_local_planner`` names, for a robot (m). Raises ParameterError."""
    plugin = _planner("~base_local_planner", DEFAULT_LOCAL, LocalPlanner)
    return plugin.make(plugin.settings, radius, footprint)  # type: ignore[no-any-return]


def global_planner_namespace() -> str:
    """Return where the global planner's parameters and topics are, below the node's own."""
    return _namespace(parameter("~base_global_planner", str, DEFAULT_GLOBAL))


def local_planner_namespace() -> str:
    """Return where the local planner's parameters and topics are, below the node's own."""
    return _namespace(parameter("~base_local_planner", str, DEFAULT_LOCAL))


def make_recoveries() -> List[RecoveryBehavior]:
    """Make the behaviours that ``~recovery_behaviors`` lists, else move_base's own. Raises ParameterError."""
    listed = read_parameter("~recovery_behaviors")
    if listed is None:
        radius = not_negative("~local_costmap/robot_radius", 0.46)
        return default_recoveries(
            not_negative("~conservative_reset_dist", 3.0),
            not_negative("~aggressive_reset/reset_distance", 4.0 * radius),
            parameter("~clearing_rotation_allowed", bool, True),
            _of_standin("rotate_recovery", RotateRecovery),
        )
    where = rospy.resolve_name("~recovery_behaviors")
    if not isinstance(listed, list):
        raise ParameterError(f"parameter {where} must be a list of mappings with name and type, not {listed!r}")
    made = [_recovery(where, item) for item in listed]
    names = [behavior.name for behavior in made]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise ParameterError(f"parameter {where}: the name {twice[0]!r} is there twice")
    return made


def _recovery(where: str, item: Any) -> RecoveryBehavior:
    if not isinstance(item, dict) or not isinstance(item.get("name"), str) or not isinstance(item.get("type"), str):
        raise ParameterError(f"parameter {where}: each entry needs a name and a type, not {item!r}")
    plugin = _plugin(where, item["type"], item["name"], RecoveryBehavior)
    return plugin.make(item["name"], plugin.settings)  # type: ignore[no-any-return]


def _planner(name: str, default: str, base: type) -> _Plugin:
    path = parameter(name, str, default)
    return _plugin(rospy.resolve_name(name), path, _namespace(path), base)


def _namespace(path: str) -> str:
    """Return the last part of a class path."""
    return path.replace("/", ".").rsplit(".", 1)[-1]


def prepare(planner: GlobalPlanner, costmap: Costmap) -> None:
    """Have the planner prepared for a map, for the most part, before the first goal."""
    enough = time.monotonic() + PREPARATION
    while planner.prepare(costmap) and time.monotonic() < enough:
        pass


def _plugin(named_by: str, path: str, namespace: str, base: type) -> _Plugin:
    kind = _load(named_by, path, base)
    given = {key: value for key, value in parameter("~" + namespace, dict, {}).items() if key not in OF_THE_NODE}
    if kind not in OWN_SETTINGS:
        return _Plugin(kind, namespace, given, named_by)
    known = OWN_SETTINGS[kind]
    if path in STANDINS:
        return _Plugin(kind, namespace, _of_standin(namespace, kind), named_by)
    return _Plugin(kind, namespace, _checked(namespace, given, known), named_by)


def _of_standin(namespace: str, kind: type) -> Dict[str, Any]:
    """Return what a class knows of parameters that were made for another plugin, which has some of its own."""
    known = OWN_SETTINGS[kind]
    given = parameter("~" + namespace, dict, {})
    return _checked(namespace, {key: value for key, value in given.items() if key in known}, known)


def _checked(namespace: str, given: Dict[str, Any], known: Dict[str, Any]) -> Dict[str, Any]:
    """Return parameters, each of the kind of its default. Raises ParameterError for others and for unknown ones."""
    unknown = sorted(set(given) - set(known))
    if unknown:
        name = rospy.resolve_name(f"~{namespace}/{unknown[0]}")
        raise ParameterError(f"parameter {name} is unknown; known are {', '.join(sorted(known))}")
    checked: Dict[str, Any] = {}
    for key in given:
        name = f"~{namespace}/{key}"
        if isinstance(known[key], float):
            checked[key] = not_negative(name, known[key])
        else:
            checked[key] = parameter(name, type(known[key]), known[key])
            if checked[key] < 1:
                raise ParameterError(f"parameter {rospy.resolve_name(name)} must be 1 or more, not {checked[key]}")
    return checked


def _load(named_by: str, path: str, base: type) -> Type[Any]:
    """Return the class of a class path. Raises ParameterError."""
    if path in STANDINS:
        rospy.logwarn("%s: %s is a C++ plugin; %s stands in for it", named_by, path, STANDINS[path])
        path = STANDINS[path]
    path = MOVED.get(path, path)
    module, _, attribute = path.rpartition(".")
    try:
        kind = getattr(importlib.import_module(module), attribute)
    except Exception as error:  # noqa: BLE001 a user's module may raise anything
        raise ParameterError(f"{named_by}: no class {path!r}: {error}") from error
    if not (isinstance(kind, type) and issubclass(kind, base)):
        raise ParameterError(f"{named_by}: {path} is no subclass of {base.__module__}.{base.__name__}")
    return kind
