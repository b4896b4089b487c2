"""The interface node: reads its parameters and runs the interfaces that they describe."""

import os
from typing import Any, Dict, Mapping, Sequence, Tuple

import rospkg
import rospy
import yaml

from rosoclingo.interfaces.config import ConfigError, InterfaceSpec, read_limits, read_specs
from rosoclingo.interfaces.configured import ConfiguredInterface
from rosoclingo.interfaces.worker import Worker
from rosoclingo.reasoning.labels import DEFAULT_FRAME, LabelError, LabelTable

_OVERRIDES = ("timeout", "server_timeout", "retries")


class InterfacesNode:
    """One ROS node that hosts one or several configured interfaces on one worker thread.

    Parameters
    ----------
        ~interfaces (mapping): the entries, as config.py describes them.  Default: those of config/interfaces.yaml.
        ~names (list): which of them this node runs.  Default: what the script says, else all.
        ~labels (mapping): named locations, `{office1: {x: 1.0, y: 2.0, yaw: 0.0}}`.  Default: none, so that an entry
            that asks for the pose of a label returns unknown_label.
        ~frame (string, "map"): tf frame of labels that name none.
        ~server, ~timeout, ~server_timeout, ~retries: in place of the entry's own, if the node runs a single interface.
    Topics and actions: those of Interface, for each.
    Raises ConfigError, listing every fault, if a parameter cannot be used.

    """

    def __init__(self, names: Sequence[str] = ()) -> None:
        labels = _labels()
        specs = _override(_choose(read_specs(_entries()), rospy.get_param("~names", list(names))))
        self._worker = Worker()
        self.interfaces = tuple(ConfiguredInterface(spec, labels, worker=self._worker) for spec in specs)
        rospy.on_shutdown(self._worker.stop)
        self._worker.start()


def run(node_name: str, names: Sequence[str] = ()) -> int:
    """Be an interface node until shutdown; the exit code: 0, or 1 if a parameter cannot be used."""
    rospy.init_node(node_name)
    try:
        InterfacesNode(names)
    except ConfigError as error:
        rospy.logfatal("%s: %s", rospy.get_name(), error)
        return 1
    rospy.spin()
    return 0


def _labels() -> LabelTable:
    try:
        return LabelTable.from_mapping(rospy.get_param("~labels", {}), rospy.get_param("~frame", DEFAULT_FRAME))
    except LabelError as error:
        raise ConfigError(f"~labels: {error}") from error


def _entries() -> Any:
    entries = rospy.get_param("~interfaces", None)
    if entries is not None:
        return entries
    path = os.path.join(rospkg.RosPack().get_path("rosoclingo"), "config", "interfaces.yaml")
    with open(path, encoding="utf-8") as stream:
        return yaml.safe_load(stream)


def _choose(specs: Mapping[str, InterfaceSpec], names: Any) -> Tuple[InterfaceSpec, ...]:
    if not isinstance(names, list):
        raise ConfigError(f"~names must be a list of interface names, not {names!r}")
    missing = [str(name) for name in names if name not in specs]
    if missing:
        message = "~names: no entry {} in ~interfaces; entries are {}"
        raise ConfigError(message.format(", ".join(missing), ", ".join(specs)))
    return tuple(specs[name] for name in names or specs)


def _override(specs: Tuple[InterfaceSpec, ...]) -> Tuple[InterfaceSpec, ...]:
    given: Dict[str, Any] = {name: rospy.get_param("~" + name) for name in _OVERRIDES if rospy.has_param("~" + name)}
    server = rospy.get_param("~server", None)
    if not given and server is None:
        return specs
    if len(specs) != 1:
        raise ConfigError(
            "~server, ~timeout, ~server_timeout and ~retries need a node with a single interface (~names)"
        )
    if server is not None and (not isinstance(server, str) or not server):
        raise ConfigError(f"~server must be the name of an actionlib server, not {server!r}")
    spec = specs[0]
    return (spec._replace(server=server or spec.server, limits=read_limits(given, "~", spec.limits)),)
