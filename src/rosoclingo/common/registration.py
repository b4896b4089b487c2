"""Register a node again at a restarted master, and connect to publishers that rospy missed.

rospy registers a node only once. Connections survive without a master, but new nodes do not find the node at a new
master.

rospy misses a publisher that registers at the same moment as the subscription: the master's update with the publisher
can arrive before its reply to the subscription, which does not list the publisher. rospy uses the later message and
never connects.
"""

import threading
from typing import Any, Dict, List, Optional, Set, Tuple

import rosgraph
import rospy
from rospy.impl.registration import get_service_manager, get_topic_manager

from rosoclingo.common.connections import connected_nodes, on_reachable_hosts
from rosoclingo.common.worker import ending
from rosoclingo.common.xmlrpc_api import FAULTS, api

Entries = Set[Tuple[str, ...]]

#: Seconds of wall time between two requests to the master.
PERIOD = 2.0

#: Number of comparisons with all entries of the master after a change: two find a publisher that rospy missed.
LOOKS = 4


class Registration:
    """Periodically compares the master's entries with this node, and registers missing ones again.

    The entries are topics, services and private parameters. For each publisher that the master lists, that rospy is not
    connected to and whose host responds, it triggers one connection attempt: rospy's own attempts can be up to a
    minute apart.

    Create it after the node has read its parameters and created its topics and services. It runs in its own thread
    until the node shuts down, as a master can take seconds to respond.
    """

    def __init__(self) -> None:
        self._name, self._uri = rospy.get_name(), rospy.get_node_uri()
        self._master = api(rosgraph.get_master_uri())
        self._parameters: Optional[Dict[str, Any]] = None  # the node's initial parameters, once read
        self._ended = threading.Event()
        self._lacking: List[Entries] = [set() for _ in range(4)]  # at the last comparison
        self._seen: Any = None  # own entries and connected publishers at the last request
        self._looks = LOOKS  # remaining comparisons
        self._lost = False
        self._asked: Entries = set()  # publishers to which rospy was asked to connect
        rospy.on_shutdown(self._ended.set)
        threading.Thread(target=self._run, name="registration", daemon=True).start()

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                self._ask()
            except FAULTS as error:
                self._lose(f"no ROS master at {rosgraph.get_master_uri()} ({error}); connections stay open")
            self._ended.wait(PERIOD)

    def _ask(self) -> None:
        """Look this node up, and compare all entries only if the node has changed or is unknown: the list is long."""
        before, self._seen = self._seen, self._own()
        known = self._master.lookupNode(self._name, self._name)[0] == 1
        self._looks = self._looks - 1 if known and self._seen == before and not self._lost else LOOKS
        if self._looks > 0:
            self._compare()

    def _compare(self) -> None:
        """Register publications, subscriptions and services that the master lacks, and connect to missed publishers.

        An entry has to be missing in two comparisons, since rospy can still be registering it.
        """
        lists = self._master.getSystemState(self._name)[2]
        listed = [{name for name, nodes in entries if self._name in nodes} for entries in lists]
        lacking = [{tuple(one) for one in own if one[0] not in names} for own, names in zip(self._seen, listed)]
        _, subscriptions, _, heard = self._seen
        publishers = dict(lists[0])
        apart = {(*one, node) for one in subscriptions for node in {*publishers.get(one[0], ())} - heard[one[0]]}
        before, self._lacking = self._lacking, [*lacking, apart]
        *missing, unheard = (now & then for now, then in zip(self._lacking, before))
        if ending():  # rospy removes its entries
            return
        if any(missing):
            self._lose("the ROS master was restarted and lacks entries of this node: registering them again")
            self._register(*missing)
        # rospy itself retries a publisher that stops responding, so one subscription is enough
        missed = unheard - self._asked
        reachable = on_reachable_hosts({node for _, _, node in missed})
        found = {one for one in missed if one[2] in reachable}
        self._subscribe({(topic, kind) for topic, kind, _ in found})
        self._asked = (self._asked & self._lacking[3]) | found
        if found != missed:
            self._looks = LOOKS
        if self._parameters is None:
            self._parameters = _parameters(self._name)
        self._lost = False

    def _own(self) -> Tuple[Any, Any, Any, Any]:
        """Return publications and subscriptions with their types, services with their URIs, and connected publishers.

        The first three are lists of pairs of str.
        """
        topics = get_topic_manager()
        subscriptions = topics.get_subscriptions()
        heard = {topic: connected_nodes(topics.get_subscriber_impl(topic)) for topic, _ in subscriptions}
        return topics.get_publications(), subscriptions, get_service_manager().get_services(), heard

    def _lose(self, text: str) -> None:
        if not self._lost:
            rospy.logwarn("%s: %s", self._name, text)
        self._lost = True

    def _register(self, publications: Entries, subscriptions: Entries, services: Entries) -> None:
        self._restore_parameters()
        for topic, kind in publications:
            self._master.registerPublisher(self._name, topic, kind, self._uri)
        self._subscribe(subscriptions)
        for service, uri in services:
            self._master.registerService(self._name, service, uri, self._uri)

    def _subscribe(self, subscriptions: Entries) -> None:
        for topic, kind in subscriptions:
            code, _, publishers = self._master.registerSubscriber(self._name, topic, kind, self._uri)
            if code == 1:
                api(self._uri).publisherUpdate("/master", topic, publishers)

    def _restore_parameters(self) -> None:
        """Set missing initial parameters of the node again, for a process that replaces it."""
        for name, value in (self._parameters or {}).items():
            if not self._master.hasParam(self._name, name)[2]:
                self._master.setParam(self._name, name, value)


def _parameters(node: str) -> Dict[str, Any]:
    own = rospy.get_param(node, {})
    found = {f"{node}/{key}": value for key, value in own.items()} if isinstance(own, dict) else {}
    simulated = rospy.get_param("/use_sim_time", None)
    return found if simulated is None else {**found, "/use_sim_time": simulated}
