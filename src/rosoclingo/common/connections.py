"""Check connections of topics: whether messages arrive at a node, and whether a sender is still connected.

rospy counts a connection at the reading end first. Messages that are published before the writing end counts the
connection are lost. So this module asks the publishers for their connections.
"""

import socket
from contextlib import suppress
from typing import Any, Dict, Iterable, List, Optional, Set
from urllib.parse import urlsplit

import rosgraph
import rospy

from rosoclingo.common.xmlrpc_api import FAULTS, address_of, api

#: Seconds after which a connection to a host that does not respond is closed.
SILENCE = 30

#: Seconds between two probes of an idle connection.
PROBE = 5

#: Time limit in seconds for a host to respond to a connection.
CONNECT_TIMEOUT = 5.0


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
    """Return the nodes that a subscriber's ``impl`` is connected to at this end; none if it is closed.

    rospy also lists connections that it tries to open: again and again if a node refuses them because it is ending,
    and for ever if the node is alive, but its topic is gone.
    """
    return {one.callerid_pub for one in topic.connections if _is_open(one)} if topic is not None else set()


def _is_open(connection: Any) -> bool:
    try:
        connection.socket.getpeername()
    except (AttributeError, OSError):
        return False
    answer = connection.header  # the publisher's, None before it
    return answer is not None and "error" not in answer


def is_connected(subscriber: rospy.Subscriber, header: Any) -> bool:
    """Return whether the connection of a message with this `_connection_header` is open: one object per connection."""
    return any(one.header is header and one.socket is not None for one in subscriber.impl.connections)


def limit_silence(subscriber: rospy.Subscriber, header: Any) -> None:
    """Limit the silence of the connection with this `_connection_header`, as :func:`close_dead` does."""
    for connection in subscriber.impl.connections:
        if connection.header is header:
            close_dead(connection)


def close_dead(connection: Any) -> None:
    """Let the kernel close a connection once the other host has not responded for SILENCE seconds.

    rospy's own limit for an idle subscriber is 150 s, and a publisher with unsent messages waits for some 15 minutes.
    After a shorter loss of the link, TCP delivers all messages.
    """
    options = {socket.TCP_KEEPIDLE: PROBE, socket.TCP_KEEPINTVL: PROBE, socket.TCP_USER_TIMEOUT: SILENCE * 1000}
    with suppress(AttributeError, OSError):  # already closed, or no TCP socket
        connection.socket.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        for option, value in options.items():
            connection.socket.setsockopt(socket.IPPROTO_TCP, option, value)


def on_reachable_hosts(nodes: Iterable[str]) -> Set[str]:
    """Return the nodes whose hosts respond to a connection, also by refusing it. Raises FAULTS without a master."""
    found: Set[str] = set()
    dead: Set[Optional[str]] = set()
    for node in nodes:
        address = urlsplit(address_of(node))
        if address.hostname in dead:
            continue
        try:
            socket.create_connection((address.hostname or "", address.port or 0), CONNECT_TIMEOUT).close()
        except ConnectionRefusedError:
            found.add(node)
        except OSError:
            dead.add(address.hostname)
        else:
            found.add(node)
    return found


def _publishers(topic: str) -> List[str]:
    with suppress(*FAULTS):
        code, _, state = api(rosgraph.get_master_uri()).getSystemState(rospy.get_name())
        published: Dict[str, List[str]] = dict(state[0]) if code == 1 else {}
        return published.get(topic, [])
    return []
