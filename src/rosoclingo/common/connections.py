"""Whether all that is published on a topic comes to a node, and whether who sent a message is still there.

rospy counts a connection at its reading end first, and what is published before the writing end counts it as well is
lost. So those who publish are asked whom they write to.
"""

from contextlib import suppress
from typing import Any, Dict, Iterable, List, Optional, Set

import rosgraph
import rospy

from rosoclingo.common.xmlrpc_api import FAULTS, address_of, api

__all__ = ["comes_to", "heard_nodes", "is_connected", "readers"]


def comes_to(reader: str, topic: str, publishers: Iterable[str] = (), none_will_do: bool = False) -> bool:
    """Whether all that is published on a topic from now on comes to the node ``reader``; names are full ones.

    All nodes that publish it and answer have to write it to the reader: at least one node unless ``none_will_do``, and
    the ``publishers`` among them.
    """
    asked = {node: readers(node) for node in _publishers(topic)}
    answers = {node: found.get(topic, set()) for node, found in asked.items() if found is not None}
    enough = (bool(answers) or none_will_do) and answers.keys() >= set(publishers)
    return enough and all(reader in found for found in answers.values())


def readers(node: str) -> Optional[Dict[str, Set[str]]]:
    """Return topics of a node, each with the nodes to which it writes it; None where it does not answer."""
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


def heard_nodes(topic: Any) -> Set[str]:
    """Return the nodes that a subscriber's ``impl`` is connected to at this end; none where it is closed."""
    return {connection.callerid_pub for connection in topic.connections} if topic is not None else set()


def is_connected(subscriber: rospy.Subscriber, header: Any) -> bool:
    """Whether the connection lasts by which a message with this `_connection_header` came: one object for all of it."""
    return any(one.header is header and one.socket is not None for one in subscriber.impl.connections)


def _publishers(topic: str) -> List[str]:
    with suppress(*FAULTS):
        code, _, state = api(rosgraph.get_master_uri()).getSystemState(rospy.get_name())
        published: Dict[str, List[str]] = dict(state[0]) if code == 1 else {}
        return published.get(topic, [])
    return []
