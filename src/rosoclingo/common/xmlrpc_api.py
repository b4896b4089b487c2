"""Clients with a time limit for the XML-RPC interfaces of ROS's master and nodes; rosgraph's have none."""

import xmlrpc.client
from http.client import HTTPException
from typing import Any

#: Exceptions of a call without a response, or with a response that is not of ROS.
FAULTS = (OSError, HTTPException, xmlrpc.client.Error)

#: Time limit in seconds of wall time for each response.
_ANSWER = 5.0


class _Transport(xmlrpc.client.Transport):
    def make_connection(self, host: Any) -> Any:
        """Create a connection with a time limit."""
        connection = super().make_connection(host)
        connection.timeout = _ANSWER
        return connection


def api(uri: str) -> Any:
    """Return the API of a master or node; its calls return (code, message, value) and raise FAULTS."""
    return xmlrpc.client.ServerProxy(uri, transport=_Transport())


def address_of(node: str) -> str:
    """Return the URI of a node's API, empty if the master does not know the node; raises FAULTS."""
    import rosgraph  # here, because a script can lack ROS itself
    import rospy

    return str(api(rosgraph.get_master_uri()).lookupNode(rospy.get_name(), node)[2] or "")
