"""The interface node: reads its parameters and runs the configured interfaces."""

import os
from pathlib import Path
from typing import Callable, Mapping, Optional, Sequence, Tuple

import rospkg
import rospy

from rosoclingo.common.labels import DEFAULT_FRAME, LabelTable
from rosoclingo.common.parameters import Parameters
from rosoclingo.common.reading import Reader, likely, read_yaml
from rosoclingo.common.starting import node_arguments, run_node
from rosoclingo.common.worker import Worker
from rosoclingo.interfaces.attempt import DEFAULT_LIMITS
from rosoclingo.interfaces.base import DEFAULT_MEMORY
from rosoclingo.interfaces.config import ConfigError, InterfaceSpec, read_limits, read_values, ros_name, survey
from rosoclingo.interfaces.configured import ConfiguredInterface
from rosoclingo.interfaces.templates import label_references
from rosoclingo.interfaces.type_faults import type_faults

_OWN = ("server", "timeout", "server_timeout", "pause", "retries", "repeatable")


class InterfacesNode:
    """One ROS node that hosts one or several configured interfaces on one worker thread.

    Topics and actions are those of Interface, for each interface. Raises ConfigError, which lists all faults of the
    parameters.

    Parameters
    ----------
        ~interfaces (map, optional): the entries, see doc/interfaces.md; default: config/interfaces.yaml.
        ~values (map, default {}): the values of variables in the names of entries, {R: [r1, r2]} for move_base(R).
        ~names (list of str, default []): the interfaces of this node; default: those of the script, else all.
        ~labels (map, optional): named locations, `{office1: {x: 1.0, y: 2.0, yaw: 0.0}}`. Without them, an action that
            needs the pose of a label returns unknown_label.
        ~frame (str, default "map"): tf frame of labels without a frame.
        ~server (str, optional): overrides the entry, if the node runs a single interface.
        ~timeout (float, optional): overrides the entry, if the node runs a single interface.
        ~server_timeout (float, optional): overrides the entry, if the node runs a single interface.
        ~pause (float, optional): overrides the entry, if the node runs a single interface.
        ~retries (int, optional): overrides the entry, if the node runs a single interface.
        ~repeatable (bool, optional): overrides the entry, if the node runs a single interface.
        ~memory (str, optional): folder in which the node records begun and answered actions, so that it repeats none
            after it was killed; empty: no file; default: rosoclingo/interfaces in ROS's home.

    """

    def __init__(self, names: Sequence[str] = ()) -> None:
        labels, specs, memory = _settings(names)
        self._worker = Worker()
        self.interfaces = tuple(ConfiguredInterface(spec, labels, worker=self._worker, memory=memory) for spec in specs)
        rospy.on_shutdown(self._worker.stop)
        self._worker.start()


def run(node_name: str, names: Sequence[str] = ()) -> int:
    """Run an interface node until shutdown; return the exit code: 0, or 1 for an invalid parameter."""
    node_arguments(InterfacesNode, node_name)
    return run_node(node_name, InterfacesNode, (ConfigError,), [names])


def _settings(names: Sequence[str]) -> Tuple[LabelTable, Tuple[InterfaceSpec, ...], Optional[Path]]:
    """Read the parameters.  Raises ConfigError, which lists all their faults."""
    given = Parameters()
    places, frame = given.at("labels"), given.at("frame").text(DEFAULT_FRAME)
    labels = LabelTable.read(places, frame) if places.given else LabelTable()
    entries = _entries(given.at("interfaces"), rospy.loginfo if names else rospy.logwarn)
    known = survey(entries, read_values(given.at("values")))
    specs = _choose(known, given.at("names"), names) if known else ()
    entries.faults += dict.fromkeys(entries.source + fault for spec in specs for fault in type_faults(spec))
    specs = _override(specs, given)
    memory = given.at("memory").text(str(DEFAULT_MEMORY), empty=True)
    given.faults += entries.faults
    given.check(ConfigError)
    for spec in specs if not labels else ():
        if label_references(spec.goal):
            text = "%s: %s needs labels, but ~labels is empty: each of its actions will return unknown_label"
            rospy.logwarn(text, rospy.get_name(), spec.name)
    return labels, specs, Path(memory).expanduser() if memory else None


def _entries(given: Reader, say: Callable[..., None]) -> Reader:
    """Return the reader of the entries; ``say`` logs that they are the default ones."""
    if given.given:
        return Reader(given.value, source="~interfaces: ")
    path = os.path.join(rospkg.RosPack().get_path("rosoclingo"), "config", "interfaces.yaml")
    say("%s: ~interfaces is not set: reading the entries of %s", rospy.get_name(), path)
    return read_yaml(path, "the interfaces of", ConfigError)


def _choose(specs: Mapping[str, InterfaceSpec], given: Reader, names: Sequence[str]) -> Tuple[InterfaceSpec, ...]:
    chosen = given.texts(tuple(names), "a list of interface names") or tuple(specs)
    for name in chosen:
        if name not in specs:
            given.fault(f"~interfaces has no entry {name}{likely(name, specs)}; its entries are {', '.join(specs)}")
    return tuple(specs[name] for name in chosen if name in specs)


def _override(specs: Tuple[InterfaceSpec, ...], given: Parameters) -> Tuple[InterfaceSpec, ...]:
    name = ros_name(given.at("server"), "an actionlib server", "")
    limits = read_limits(given, specs[0].limits if specs else DEFAULT_LIMITS)
    repeatable = given.at("repeatable").flag(bool(specs) and specs[0].repeatable)
    own = [one for one in _OWN if given.at(one).given]
    if own and len(specs) > 1:
        text = "{} and ~{} need a node with a single interface (~names)"
        text = text.format(", ".join(f"~{one}" for one in _OWN[:-1]), _OWN[-1])
        given.faults.append(text)
    if not own or len(specs) != 1:
        return specs
    return (specs[0]._replace(server=name or specs[0].server, limits=limits, repeatable=repeatable),)
