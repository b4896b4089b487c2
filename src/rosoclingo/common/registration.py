"""A node's entry at the master, made again where the master was restarted; rospy makes it only once.

What is connected stays connected without a master. But a new one knows no node, and so nobody new finds them.
"""

import threading
from typing import Any, Dict, Optional

import rosgraph
import rospy
from rospy.impl.registration import get_service_manager

from rosoclingo.common.worker import ending
from rosoclingo.common.xmlrpc_api import FAULTS, api

__all__ = ["Registration"]

#: Seconds of wall time between two questions to the master.
PERIOD = 2.0


class Registration:
    """Asks the master whether it knows this node, and where not tells it topics, services and private parameters.

    Made by a node that has read its parameters and asked for all it wants; asks until the node ends, in a thread of
    its own, as a master may take seconds to answer.
    """

    def __init__(self, period: float = PERIOD) -> None:
        self._name, self._uri = rospy.get_name(), rospy.get_node_uri()
        self._master = api(rosgraph.get_master_uri())
        self._parameters: Optional[Dict[str, Any]] = None  # what the node was started with, once asked for
        self._ended = threading.Event()
        self._period = period
        self._lost = False
        rospy.on_shutdown(self._ended.set)
        threading.Thread(target=self._run, name="registration", daemon=True).start()

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                self._ask()
            except FAULTS as error:
                self._lose(f"no ROS master at {rosgraph.get_master_uri()} ({error}); connected nodes go on without")
            self._ended.wait(self._period)

    def _ask(self) -> None:
        known = self._master.lookupNode(self._name, self._name)[0] == 1  # by this node or, later, by its namesake
        if known or ending():  # a node that ends has taken its entry back
            self._lost = False
            self._parameters = _parameters(self._name) if self._parameters is None else self._parameters
            return
        self._lose("the ROS master was restarted and does not know this node: it is told again")
        self._register()
        self._lost = False

    def _lose(self, text: str) -> None:
        if not self._lost:
            rospy.logwarn("%s: %s", self._name, text)
        self._lost = True

    def _register(self) -> None:
        self._restore_parameters()
        own = api(self._uri)
        for topic, kind in own.getPublications(self._name)[2]:
            self._master.registerPublisher(self._name, topic, kind, self._uri)
        for topic, kind in own.getSubscriptions(self._name)[2]:
            code, _, publishers = self._master.registerSubscriber(self._name, topic, kind, self._uri)
            if code == 1:
                own.publisherUpdate("/master", topic, publishers)
        for service, uri in get_service_manager().get_services():  # nodes have no question for these
            self._master.registerService(self._name, service, uri, self._uri)

    def _restore_parameters(self) -> None:
        """Set what the node was started with, for a process that takes its place; what is there already stays."""
        for name, value in (self._parameters or {}).items():
            if not self._master.hasParam(self._name, name)[2]:
                self._master.setParam(self._name, name, value)


def _parameters(node: str) -> Dict[str, Any]:
    own = rospy.get_param(node, {})
    found = {f"{node}/{key}": value for key, value in own.items()} if isinstance(own, dict) else {}
    simulated = rospy.get_param("/use_sim_time", None)
    return found if simulated is None else {**found, "/use_sim_time": simulated}
