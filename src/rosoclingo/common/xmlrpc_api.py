"""The XML-RPC interfaces of ROS's master and nodes, asked with a time limit; rosgraph's own waits without one."""

import xmlrpc.client
from http.client import HTTPException
from typing import Any

__all__ = ["FAULTS", "address_of", "api"]

#: What a call may raise where nobody answers, or not as ROS does.
FAULTS = (OSError, HTTPException, xmlrpc.client.Error)

#: Seconds of wall time in which each connection has to answer.
_ANSWER = 5.0


class _Transport(xmlrpc.client.Transport):
    def make_connection(self, host: Any) -> Any:
        """Give up a connection that takes too long."""
        connection = super().make_connection(host)
        connection.timeout = _ANSWER
        return connection


def api(uri: str) -> Any:
    """Return the interface of a master or node; its calls return (code, message, value) and raise FAULTS."""
    return xmlrpc.client.ServerProxy(uri, transport=_Transport())


def address_of(node: str) -> str:
    """Return where a node has its interface, empty where the master does not know it; raises FAULTS."""
    import rosgraph  # here, as what a script lacks may be ROS itself
    import rospy

    return str(api(rosgraph.get_master_uri()).lookupNode(rospy.get_name(), node)[2] or "")
