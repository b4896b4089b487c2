"""Private parameters of a node: reports all faults at once, and unread parameters, which are probably misspelt."""

from typing import AbstractSet, Any, Callable, Dict, Iterator, List, Mapping, Optional, Set, Type

import rospy

from rosoclingo.common.reading import MISSING, Reader, likely
from rosoclingo.common.xmlrpc_api import FAULTS

#: Parameters that ROS's own libraries read.
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
    """Invalid parameters; the message names each with its valid values."""


class Parameters(Reader):
    """The node's private parameters, or ``values`` in their place; records which of them are read."""

    def __init__(self, values: Optional[Mapping[str, Any]] = None) -> None:
        super().__init__(_private() if values is None else values, "~")

    def at(self, key: str) -> Reader:
        """Return the reader of a parameter; a name in a group has slashes."""
        _READ.add(key)
        where = f" in the launch file, or on the command line as _{key}:=..."
        return Reader(self._find(key), f"~{key}", "", where, "/", self.faults)

    def has(self, key: str) -> bool:
        """Return whether a parameter is set, without recording it as read."""
        return self._find(key) is not MISSING

    def _find(self, key: str) -> Any:
        found: Any = self.value
        for part in key.split("/"):
            found = found.get(part, MISSING) if isinstance(found, Mapping) else MISSING
        return found

    def group(self, name: str) -> Callable[[str], Reader]:
        """Return a function that maps the names in a group to the readers of its parameters."""
        return lambda key: self.at(f"{name}/{key}")

    def check(self, error: Type[Exception] = ParameterError) -> None:
        """Raise ParameterError, or ``error``, with all faults so far, if there are any."""
        super().check(error)


def warn_of_unread() -> None:
    """Log the private parameters that the node has not read; call this after it has read all."""
    try:
        found = unread(_private(), frozenset(_READ))
    except FAULTS:  # a master that died meanwhile is not a reason to end
        return
    if found:
        rospy.logwarn("%s: unknown parameters: %s", rospy.get_name(), ", ".join(found))


def unread(values: Mapping[str, Any], read: AbstractSet[str]) -> List[str]:
    """Return the parameters that are not in ``read`` (names with slashes), each with the likely name, if any.

    A group of which nothing was read counts as one parameter.
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
