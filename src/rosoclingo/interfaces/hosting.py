"""The interface node: reads its parameters and runs the interfaces that they describe."""

import os
from typing import Any, Callable, Dict, List, Mapping, Sequence, Tuple

import rospkg
import rospy
import yaml

from rosoclingo.common.labels import DEFAULT_FRAME, LabelError, LabelTable
from rosoclingo.common.private_parameters import has_parameter, read_parameter
from rosoclingo.common.starting import node_arguments, run_node
from rosoclingo.common.worker import Worker
from rosoclingo.interfaces.config import ConfigError, InterfaceSpec, read_limits, survey
from rosoclingo.interfaces.configured import ConfiguredInterface, type_faults
from rosoclingo.interfaces.templates import uses_labels

_OVERRIDES = ("timeout", "server_timeout", "pause", "retries")


class InterfacesNode:
    """One ROS node that hosts one or several configured interfaces on one worker thread.

    Parameters
    ----------
        ~interfaces (mapping): the entries, as config.py describes them.  Default: those of config/interfaces.yaml.
        ~names (list): which of them this node runs.  Default: what the script says, else all.
        ~labels (mapping): named locations, `{office1: {x: 1.0, y: 2.0, yaw: 0.0}}`.  Default: none, so that an entry
            that asks for the pose of a label returns unknown_label.
        ~frame (string, "map"): tf frame of labels that name none.
        ~server, ~timeout, ~server_timeout, ~pause, ~retries: in place of the entry's own, if the node runs a single
            interface.
    Topics and actions: those of Interface, for each.
    Raises ConfigError, listing every fault, if a parameter cannot be used.

    """

    def __init__(self, names: Sequence[str] = ()) -> None:
        labels, specs = _settings(names)
        self._worker = Worker()
        self.interfaces = tuple(ConfiguredInterface(spec, labels, worker=self._worker) for spec in specs)
        rospy.on_shutdown(self._worker.stop)
        self._worker.start()


def run(node_name: str, names: Sequence[str] = ()) -> int:
    """Be an interface node until shutdown; the exit code: 0, or 1 if a parameter cannot be used."""
    node_arguments(InterfacesNode, node_name)
    return run_node(node_name, InterfacesNode, (ConfigError,), [names])


def _settings(names: Sequence[str]) -> Tuple[LabelTable, Tuple[InterfaceSpec, ...]]:
    """The parameters. Raises ConfigError listing all that is wrong with them."""
    faults: List[str] = []
    labels = _labels(faults)
    entries, where = _entries(rospy.loginfo if names else rospy.logwarn)
    known, found = survey(entries)
    specs = _choose(known, read_parameter("~names", list(names)), faults) if known else ()
    found += [fault for spec in specs for fault in type_faults(spec)]
    specs = _override(specs, faults)
    faults += [f"{where} {fault}" for fault in found]
    if faults:
        raise ConfigError("\n".join(faults))
    _warn(labels, specs)
    return labels, specs


def _warn(labels: LabelTable, specs: Tuple[InterfaceSpec, ...]) -> None:
    """Say what is odd but may be meant."""
    for spec in specs:
        if not labels and uses_labels(spec.goal):
            text = "%s: %s asks for labels, but ~labels is empty: each of its actions will return unknown_label"
            rospy.logwarn(text, rospy.get_name(), spec.name)


def _labels(faults: List[str]) -> LabelTable:
    try:
        return LabelTable.from_mapping(read_parameter("~labels", {}), read_parameter("~frame", DEFAULT_FRAME))
    except LabelError as error:
        faults.append(f"~labels: {error}")
        return LabelTable()


def _entries(say: Callable[..., None]) -> Tuple[Any, str]:
    """The entries, and how messages call the place where they stand; ``say`` hears where they are not the user's."""
    entries = read_parameter("~interfaces")
    if entries is not None:
        return entries, "~interfaces:"
    path = os.path.join(rospkg.RosPack().get_path("rosoclingo"), "config", "interfaces.yaml")
    say("%s: ~interfaces is not set: the entries are those of %s", rospy.get_name(), path)
    with open(path, encoding="utf-8") as stream:
        return yaml.safe_load(stream), f"{path}:"


def _choose(specs: Mapping[str, InterfaceSpec], names: Any, faults: List[str]) -> Tuple[InterfaceSpec, ...]:
    if not isinstance(names, list):
        faults.append(f"~names must be a list of interface names, not {names!r}")
        return tuple(specs.values())
    missing = [str(name) for name in names if name not in specs]
    if missing:
        message = "~names: no entry {} in ~interfaces; entries are {}"
        faults.append(message.format(", ".join(missing), ", ".join(specs)))
    return tuple(specs[name] for name in names or specs if name in specs)


def _override(specs: Tuple[InterfaceSpec, ...], faults: List[str]) -> Tuple[InterfaceSpec, ...]:
    given: Dict[str, Any] = {name: read_parameter("~" + name) for name in _OVERRIDES if has_parameter("~" + name)}
    server = read_parameter("~server")
    if not given and server is None:
        return specs
    if len(specs) > 1:
        overrides = "~server, ~timeout, ~server_timeout, ~pause and ~retries"
        faults.append(f"{overrides} need a node with a single interface (~names)")
    if server is not None and (not isinstance(server, str) or not server):
        faults.append(f"~server must be the name of an actionlib server, not {server!r}")
    if len(specs) != 1:
        return specs
    spec = specs[0]
    try:
        return (spec._replace(server=server or spec.server, limits=read_limits(given, "~", spec.limits)),)
    except ConfigError as error:
        faults.append(str(error))
        return specs
