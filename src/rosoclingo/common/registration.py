"""A node's entry at the master, made again where the master was restarted; rospy makes it only once.

What is connected stays connected without a master. But a new one knows no node, and so nobody new finds them.

Publishers that rospy has missed are connected as well. Where a topic is subscribed to and published at the same moment,
the master's news of the publisher can come before its reply to the subscription, which has none: rospy takes what came
last, connects to nobody, for good.
"""

import threading
from typing import Any, Dict, List, Optional, Set, Tuple

import rosgraph
import rospy
from rospy.impl.registration import get_service_manager, get_topic_manager

from rosoclingo.common.connections import heard_nodes
from rosoclingo.common.worker import ending
from rosoclingo.common.xmlrpc_api import FAULTS, api

__all__ = ["Registration"]

Entries = Set[Tuple[str, ...]]

#: Seconds of wall time between two questions to the master.
PERIOD = 2.0

#: Number of times that the master is asked for all its entries after a change: two find a publisher that rospy missed.
LOOKS = 4


class Registration:
    """Asks the master whether it knows this node, and tells it the topics, services and private parameters it lacks.

    Trigger one connection attempt per publisher that the master lists and rospy is not connected to.

    Made by a node that has read its parameters and asked for all it wants; asks until the node ends, in a thread of
    its own, as a master may take seconds to answer.
    """

    def __init__(self) -> None:
        self._name, self._uri = rospy.get_name(), rospy.get_node_uri()
        self._master = api(rosgraph.get_master_uri())
        self._parameters: Optional[Dict[str, Any]] = None  # what the node was started with, once asked for
        self._ended = threading.Event()
        self._lacking: List[Entries] = [set() for _ in range(4)]  # at the last comparison, see _compare
        self._seen: Any = None  # own entries at the last question
        self._looks = LOOKS  # still to come
        self._lost = False
        self._asked: Entries = set()  # publishers to which rospy was asked to connect
        rospy.on_shutdown(self._ended.set)
        threading.Thread(target=self._run, name="registration", daemon=True).start()

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                self._ask()
            except FAULTS as error:
                self._lose(f"no ROS master at {rosgraph.get_master_uri()} ({error}); connected nodes go on without")
            self._ended.wait(PERIOD)

    def _ask(self) -> None:
        """Ask for this node, and for all entries where it has changed or is not known: these are long."""
        before, self._seen = self._seen, self._own()
        known = self._master.lookupNode(self._name, self._name)[0] == 1
        self._looks = self._looks - 1 if known and self._seen == before and not self._lost else LOOKS
        if self._looks > 0:
            self._compare()

    def _compare(self) -> None:
        """Register the publications, subscriptions and services that the master lacks; connect missed publishers.

        Each has to be lacking twice: rospy is about to tell the master the latest entries.
        """
        lists = self._master.getSystemState(self._name)[2]
        listed = [{name for name, nodes in entries if self._name in nodes} for entries in lists]
        lacking = [{tuple(one) for one in own if one[0] not in names} for own, names in zip(self._seen, listed)]
        before, self._lacking = self._lacking, [*lacking, _unheard(dict(lists[0]))]
        *missing, unheard = (now & then for now, then in zip(self._lacking, before))
        if ending():  # rospy takes its entries back
            return
        if any(missing):
            self._lose("the ROS master was restarted and does not know all of this node: it is told again")
            self._register(*missing)
        # rospy asks a node that does not answer again itself, so one subscription is enough
        self._subscribe({(topic, kind) for topic, kind, _ in unheard - self._asked})
        self._asked = (self._asked | unheard) & self._lacking[3]
        if self._parameters is None:
            self._parameters = _parameters(self._name)
        self._lost = False

    def _own(self) -> Tuple[Any, Any, Any]:
        """Publications and subscriptions with their types, services with their addresses: lists of pairs of str."""
        topics = get_topic_manager()
        return topics.get_publications(), topics.get_subscriptions(), get_service_manager().get_services()

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
        """Set what the node was started with, for a process that takes its place; what is there already stays."""
        for name, value in (self._parameters or {}).items():
            if not self._master.hasParam(self._name, name)[2]:
                self._master.setParam(self._name, name, value)


def _unheard(publishers: Dict[str, List[str]]) -> Entries:
    """Subscriptions with their types, each with a node among its publishers that rospy is not connected to."""
    topics = get_topic_manager()
    return {
        (topic, kind, node)
        for topic, kind in topics.get_subscriptions()
        for node in set(publishers.get(topic, ())) - heard_nodes(topics.get_subscriber_impl(topic))
    }


def _parameters(node: str) -> Dict[str, Any]:
    own = rospy.get_param(node, {})
    found = {f"{node}/{key}": value for key, value in own.items()} if isinstance(own, dict) else {}
    simulated = rospy.get_param("/use_sim_time", None)
    return found if simulated is None else {**found, "/use_sim_time": simulated}
