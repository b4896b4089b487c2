"""A node's private parameters: which of them it has read. One that nobody reads is probably misspelt."""

from difflib import get_close_matches
from typing import AbstractSet, Any, Dict, Iterator, List, Mapping, Set

import rospy

__all__ = ["has_parameter", "private_values", "read_parameter", "unread", "warn_of_unread"]

#: What the libraries of ROS read, when it pleases them.
OF_ROS = frozenset(
    {
        "actionlib_client_pub_queue_size",
        "actionlib_client_sub_queue_size",
        "actionlib_server_pub_queue_size",
        "actionlib_server_sub_queue_size",
        "actionlib_status_frequency",
        "status_frequency",
        "status_list_timeout",
        "tf_prefix",
    }
)

_READ: Set[str] = set()


class _Recorded(Mapping[str, Any]):
    """Private parameters by name; remembers which of them were asked for."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = values

    def __getitem__(self, name: str) -> Any:
        _READ.add(name)
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)


def read_parameter(name: str, default: Any = None) -> Any:
    """The value of a ROS parameter; as ``rospy.get_param``, and noted as read."""
    _note(name)
    return rospy.get_param(name, default)


def has_parameter(name: str) -> bool:
    """Whether a ROS parameter is set; noted as read."""
    _note(name)
    return bool(rospy.has_param(name))


def private_values() -> Mapping[str, Any]:
    """All private parameters by name; those that are asked for are noted as read."""
    return _Recorded(_private())


def warn_of_unread() -> None:
    """Say once which private parameters the node, which has read all it wants, does not know."""
    found = unread(_private(), frozenset(_READ))
    if found:
        rospy.logwarn("%s: parameters that it does not read: %s", rospy.get_name(), ", ".join(found))


def unread(values: Mapping[str, Any], read: AbstractSet[str]) -> List[str]:
    """The parameters that nobody has ``read`` (names with slashes), each with the likely name where there is one.

    Where a group as a whole, or nothing of it, was read, it counts as one.
    """
    return [_described(name, read) for name in sorted(_unread(values, read, "")) if name not in OF_ROS]


def _unread(values: Mapping[str, Any], read: AbstractSet[str], group: str) -> Iterator[str]:
    for key, value in values.items():
        name = f"{group}{key}"
        if name in read:
            continue
        if isinstance(value, dict) and any(one.startswith(name + "/") for one in read):
            yield from _unread(value, read, name + "/")
        else:
            yield name


def _described(name: str, read: AbstractSet[str]) -> str:
    group, _, last = name.rpartition("/")
    start = f"{group}/" if group else ""
    known = sorted({one[len(start) :].split("/")[0] for one in read if one.startswith(start)})
    close = get_close_matches(last, known, 1)
    return f"~{name} (is ~{start}{close[0]} meant?)" if close else f"~{name}"


def _note(name: str) -> None:
    if name.startswith("~"):
        _READ.add(name[1:].strip("/"))


def _private() -> Dict[str, Any]:
    values = rospy.get_param("~", {})
    return values if isinstance(values, dict) else {}
