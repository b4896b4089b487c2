#!/usr/bin/env python3
"""Measures the core's response: from the last return on in_rosoclingo to the next action on out_rosoclingo.

A master and two core nodes with the mailbot's program, one of them with a journal, run in turns. This process is the
client and the interface layer: it returns each action at once, or after some seconds. So the figures contain only the
core and ROS. The journal is in the folder for temporary files (TMPDIR).

Run it in the built workspace: ./dev exec python3 bench/response.py
"""

import os
import queue
import random
import tempfile
import time

import actionlib
import rosgraph
import rospy
from figures import Figure, Option, main, quantiles
from ros_system import System, wait_for
from rosoclingo.msg import InterfaceIO, ROSoClingoAction, ROSoClingoGoal

from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.keywords import CORE


class Responder:
    """Returns each action of the core in one namespace, and records the time until the next action.

    Attributes:
        responses: the seconds from the last return of a cycle to the next action.

    """

    def __init__(self, space, seconds=0.0):
        self._space, self._seconds, self.responses = space, seconds, []
        self._actions, self._source, self._goals = queue.Queue(), random.Random(1), 0
        self._out = rospy.Publisher(f"/{space}/in_rosoclingo", InterfaceIO, queue_size=10)
        rospy.Subscriber(f"/{space}/out_rosoclingo", InterfaceIO, self._on_action, tcp_nodelay=True)
        self._client = actionlib.ActionClient(f"/{space}/rosoclingo", ROSoClingoAction)

    def _on_action(self, message):
        if message.interface != CORE:
            self._actions.put((time.perf_counter(), message))

    def batch(self, count):
        """Send ``count`` goals at once and return actions until the goals have ended."""
        wait_for(lambda: self._client.wait_for_server(rospy.Duration(1)), "the core")
        wait_for(self._out.get_num_connections, "the subscriber of returns")
        goals, answered = [], None
        for _ in range(count):
            self._goals += 1
            start, end = self._source.sample(range(1, 5), 2)
            goals.append(self._client.send_goal(ROSoClingoGoal(f"goal(office{start},office{end},{self._goals})")))
        while any(goal.get_comm_state() != actionlib.CommState.DONE for goal in goals):
            try:
                received, message = self._actions.get(timeout=0.05)
            except queue.Empty:
                continue
            if answered is not None:
                self.responses.append(received - answered)
            time.sleep(self._seconds)
            for text in message.facts:
                action, value, cycle = parse_atom(text).arguments
                answered = time.perf_counter()
                self._out.publish(InterfaceIO(message.interface, [f"_return({action},{value},{cycle})"]))


def processor_time(node):
    """Return the seconds of processor time of a node's process."""
    master = rosgraph.Master(rospy.get_name())
    pid = rosgraph.Master(rospy.get_name(), master.lookupNode(node)).getPid()
    with open(f"/proc/{pid}/stat") as file:
        return sum(map(int, file.read().rsplit(")", 1)[1].split()[11:13])) / os.sysconf("SC_CLK_TCK")


def compare(spaces, batches, count, seconds=0.0):
    """Run the cores of some namespaces in turns; yield their figures, named by the words of each namespace.

    A first batch of each, which loads libraries, is not measured.
    """
    responders = {space: Responder(space, seconds) for space in spaces}
    for responder in responders.values():
        responder.batch(count)
        responder.responses.clear()
    before = {space: processor_time(f"/{space}/rosoclingo") for space in spaces}
    for _ in range(batches):
        for responder in responders.values():
            responder.batch(count)
    for space, words in spaces.items():
        responses = [1000 * one for one in responders[space].responses]
        spent = 1000 * (processor_time(f"/{space}/rosoclingo") - before[space])
        yield from quantiles(f"response{words}", responses, "ms")
        yield Figure(f"a cycle of the core{words}", spent / len(responses), "ms of processor")


def measure(options):
    """Yield the figures of a core without a journal and of one with it."""
    programs = [f"programs:={list(map(os.path.abspath, options.programs))}"] if options.programs else []
    with tempfile.TemporaryDirectory() as folder, System() as system:
        for space, journal in (("without", "none"), ("with", folder)):
            system.launch("core.launch", f"journal:={journal}", *programs, namespace=space)
        rospy.init_node("bench_response", disable_signals=True)
        yield from compare(
            {"without": "", "with": " with a journal"}, options.batches, options.requests, options.seconds
        )


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        batches=Option(20, "batches of requests", 5),
        requests=Option(3, "requests in a batch"),
        programs=Option([], "files of another program than the mailbot's"),
        seconds=Option(0.0, "duration of an action"),
    )
