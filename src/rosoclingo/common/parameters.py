"""A node's private parameters, read with all their faults at once. One that nobody reads is probably misspelt."""

from typing import AbstractSet, Any, Callable, Dict, Iterator, List, Mapping, Optional, Set, Type

import rospy

from rosoclingo.common.reading import MISSING, Reader, likely
from rosoclingo.common.xmlrpc_api import FAULTS

__all__ = ["ParameterError", "Parameters", "unread", "warn_of_unread"]

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


class ParameterError(ValueError):
    """Parameters that the node cannot work with; the message names each and says what it has to be."""


class Parameters(Reader):
    """The node's private parameters, or ``values`` in their place; what is asked for is noted as read."""

    def __init__(self, values: Optional[Mapping[str, Any]] = None) -> None:
        super().__init__(_private() if values is None else values, "~")

    def at(self, key: str) -> Reader:
        """The parameter of a name, with slashes where it is in a group."""
        _READ.add(key)
        where = f" in the launch file, or on the command line as _{key}:=..."
        return Reader(self._find(key), f"~{key}", "", where, "/", self.faults)

    def has(self, key: str) -> bool:
        """Whether there is a parameter of that name, which is not noted as read by this."""
        return self._find(key) is not MISSING

    def _find(self, key: str) -> Any:
        found: Any = self.value
        for part in key.split("/"):
            found = found.get(part, MISSING) if isinstance(found, Mapping) else MISSING
        return found

    def group(self, name: str) -> Callable[[str], Reader]:
        """Return what finds the parameters of a group by their names in it."""
        return lambda key: self.at(f"{name}/{key}")

    def check(self, error: Type[Exception] = ParameterError) -> None:
        """Raise ParameterError, or another, with all faults that were noted so far, if there are any."""
        super().check(error)


def warn_of_unread() -> None:
    """Say once which private parameters the node, which has read all it wants, does not know."""
    try:
        found = unread(_private(), frozenset(_READ))
    except FAULTS:  # the master went while the node started: it is no reason to end
        return
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
    group, slash, last = name.rpartition("/")
    known = sorted({one[len(group + slash) :].split("/")[0] for one in read if one.startswith(group + slash)})
    return f"~{name}{likely(last, known, '~' + group + slash)}"


def _private() -> Dict[str, Any]:
    values = rospy.get_param("~", {})
    return values if isinstance(values, dict) else {}
