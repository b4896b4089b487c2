"""The names of a node, according to the docstring of its class (doc/reference.md) and to the master."""

import runpy
from pathlib import Path
from typing import Dict, Iterator, Mapping, NamedTuple, Set, Tuple

import rosgraph
import rospy
import rosservice
from interface_helpers import wait_until

MAKER = runpy.run_path(str(Path(__file__).resolve().parents[2] / "doc" / "make_reference.py"))
PLACES = {script: node.places for node in MAKER["NODES"] for script in node.scripts}
STATUS = "actionlib_msgs/GoalStatusArray"


class Names(NamedTuple):
    """Global names: topics and services with their types."""

    published: Dict[str, str]
    subscribed: Set[str]
    services: Dict[str, str]


def documented(script: str, node: str, given: Mapping[str, Tuple[str, str]]) -> Names:
    """Return the names in the docstring of a script's node; ``given`` replaces some names and types."""
    found = MAKER["descriptions"](PLACES[script])

    def section(title: str) -> Iterator[Tuple[str, str]]:
        for entry in MAKER["entries"](found, title):
            for name, spec in entry.names:
                name, kind = given.get(name, (name, spec.split(",")[0]))
                yield rospy.names.canonicalize_name(f"{node}/{name[1:]}" if name[0] == "~" else f"/{name}"), kind

    names = Names(dict(section("Publishes")), {name for name, _ in section("Subscribes")}, dict(section("Services")))
    for name, kind in section("Actions served"):
        names.published.update({f"{name}/status": STATUS, f"{name}/feedback": f"{kind}Feedback"})
        names.published[f"{name}/result"] = f"{kind}Result"
        names.subscribed.update({f"{name}/goal", f"{name}/cancel"})
    for name, kind in section("Actions called"):
        names.published.update({f"{name}/goal": f"{kind}Goal", f"{name}/cancel": "actionlib_msgs/GoalID"})
        names.subscribed.update({f"{name}/{topic}" for topic in ("status", "feedback", "result")})
    return names


def offered(node: str) -> Names:
    """Return the names that the master lists for a node, except those of every node."""
    master = rosgraph.Master(rospy.get_name())
    state, types = master.getSystemState(), dict(master.getTopicTypes())  # in this order: no topic without its type
    published, subscribed, services = ({name for name, nodes in part if node in nodes} for part in state)
    own = {name for name in services if not name.endswith(("logger_level", "get_loggers", "tf2_frames"))}
    return Names(
        {name: types[name] for name in published - {"/rosout"}},
        subscribed - {"/clock"},
        {name: rosservice.get_service_type(name) for name in own},
    )


def check_names(script: str, node: str, given: Mapping[str, Tuple[str, str]]) -> None:
    """Wait until a node that has just started has the documented names."""
    wanted, found = documented(script, node, given), []
    try:
        wait_until(lambda: found.append(offered(node)) or found[-1] == wanted, f"{node} to have the documented names")
    except AssertionError as error:
        raise AssertionError(f"{error}: {found[-1]} instead of {wanted}") from error
