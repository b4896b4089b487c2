"""Check connections of topics: whether messages arrive at a node, and whether a sender is still connected.

rospy counts a connection at the reading end first. Messages that are published before the writing end counts the
connection are lost. So this module asks the publishers for their connections.
"""

from contextlib import suppress
from typing import Any, Dict, Iterable, List, Optional, Set

import rosgraph
import rospy

from rosoclingo.common.xmlrpc_api import FAULTS, address_of, api

__all__ = ["connected_nodes", "is_connected", "is_delivered_to", "readers"]


def is_delivered_to(reader: str, topic: str, publishers: Iterable[str] = (), allow_none: bool = False) -> bool:
    """Return whether all messages published on a topic from now on arrive at the node ``reader``; names are absolute.

    All responding publishers of the topic have to be connected to the reader, including ``publishers``. There has to be
    at least one, unless ``allow_none``.
    """
    asked = {node: readers(node) for node in _publishers(topic)}
    answers = {node: found.get(topic, set()) for node, found in asked.items() if found is not None}
    enough = (bool(answers) or allow_none) and answers.keys() >= set(publishers)
    return enough and all(reader in found for found in answers.values())


def readers(node: str) -> Optional[Dict[str, Set[str]]]:
    """Return the published topics of a node, each with its subscribed nodes; None if the node does not respond."""
    me = rospy.get_name()
    with suppress(*FAULTS):
        uri = address_of(node)
        code, _, connections = api(uri).getBusInfo(me) if uri else (0, "", [])
        if code == 1:
            found: Dict[str, Set[str]] = {}
            for _, other, direction, _, topic, *_ in connections:
                if direction == "o":
                    found.setdefault(topic, set()).add(other)
            return found
    return None


def connected_nodes(topic: Any) -> Set[str]:
    """Return the nodes that a subscriber's ``impl`` is connected to at this end; none if it is closed."""
    return {connection.callerid_pub for connection in topic.connections} if topic is not None else set()


def is_connected(subscriber: rospy.Subscriber, header: Any) -> bool:
    """Return whether the connection of a message with this `_connection_header` is open: one object per connection."""
    return any(one.header is header and one.socket is not None for one in subscriber.impl.connections)


def _publishers(topic: str) -> List[str]:
    with suppress(*FAULTS):
        code, _, state = api(rosgraph.get_master_uri()).getSystemState(rospy.get_name())
        published: Dict[str, List[str]] = dict(state[0]) if code == 1 else {}
        return published.get(topic, [])
    return []
