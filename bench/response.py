#!/usr/bin/env python3
"""Measures the core's response: from the last return on in_rosoclingo to the next action on out_rosoclingo.

Three core nodes with the mailbot's program run in turns: one alone, one with a journal, and one with a page (rosrun
rosoclingo web) and viewers. This process is the client and the interface layer: it returns each action at once, or
after some seconds. So the figures contain only the core and ROS. The journal is in the folder for temporary files
(TMPDIR). The viewers connect over WebSockets like browsers. They run in a separate process with the lowest priority,
since real viewers run on other machines.

Run it in the built workspace: ./dev exec python3 bench/response.py
"""

import asyncio
import multiprocessing
import os
import queue
import random
import tempfile
import time

import actionlib
import rosgraph
import rospy
from figures import Figure, Option, main, processor_time, quantiles
from ros_system import System
from rosoclingo.msg import InterfaceIO, ROSoClingoAction, ROSoClingoGoal
from std_msgs.msg import String
from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect
from waiting import PATIENCE, wait_until

from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.keywords import CORE

VIEWERS = 10
SPACES = {"alone": "", "journal": " with a journal", "page": f" with a page and {VIEWERS} viewers"}
"""The namespaces of the cores, with words for their figures."""


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
        wait_until(lambda: self._client.wait_for_server(rospy.Duration(1)), "the core")
        wait_until(self._out.get_num_connections, "the subscriber of returns")
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


def time_of(node):
    """Return the seconds of processor time of a node's process."""
    master = rosgraph.Master(rospy.get_name())
    return processor_time(rosgraph.Master(rospy.get_name(), master.lookupNode(node)).getPid())


def compare(batches, count, seconds):
    """Run the cores in turns; yield their figures. A first batch of each, which loads libraries, is not measured."""
    responders = {space: Responder(space, seconds) for space in SPACES}
    for responder in responders.values():
        responder.batch(count)
        responder.responses.clear()
    before = {space: time_of(f"/{space}/rosoclingo") for space in SPACES}
    for _ in range(batches):
        for responder in responders.values():
            responder.batch(count)
    for space, words in SPACES.items():
        responses = [1000 * one for one in responders[space].responses]
        spent = 1000 * (time_of(f"/{space}/rosoclingo") - before[space])
        yield from quantiles(f"response{words}", responses, "ms")
        yield Figure(f"a cycle of the core{words}", spent / len(responses), "ms of processor")


def view_all(addresses, ready):
    """Act as all viewers of the page whose address comes; ``ready`` counts those that have received the run."""

    async def run(address):
        await asyncio.gather(*(view(address, ready) for _ in range(VIEWERS)))

    os.nice(19)
    asyncio.run(run(addresses.get()))


async def view(address, ready):
    """Act as a viewer of a page."""
    request = HTTPRequest(address.replace("http:", "ws:") + "run", headers={"Origin": address.rstrip("/")})
    socket = await websocket_connect(request, compression_options={})
    await socket.read_message()
    ready.release()
    while await socket.read_message() is not None:
        pass


def measure(options):
    """Yield the figures of all cores, and the processor time of the page's node."""
    context = multiprocessing.get_context("fork")  # while this process has one thread
    addresses, ready = context.SimpleQueue(), context.Semaphore(0)
    context.Process(target=view_all, args=(addresses, ready), daemon=True).start()
    programs = [f"programs:={list(map(os.path.abspath, options.programs))}"] if options.programs else []
    with tempfile.TemporaryDirectory() as folder, System() as system:
        for space in SPACES:
            journal = folder if space == "journal" else "none"
            system.launch("core.launch", f"journal:={journal}", *programs, namespace=space)
        system.start("rosrun", "rosoclingo", "web", "_port:=0", "__name:=web", namespace="page")
        rospy.init_node("bench_response", disable_signals=True)
        addresses.put(rospy.wait_for_message("/page/web/address", String, PATIENCE).data)
        for _ in range(VIEWERS):
            wait_until(lambda: ready.acquire(timeout=1.0), "a viewer to receive the run")
        before, goals = time_of("/page/web"), (options.batches + 1) * options.requests
        yield from compare(options.batches, options.requests, options.seconds)
        spent = 1000 * (time_of("/page/web") - before)
        yield Figure("the page's node, a goal", spent / goals, "ms of processor")


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        batches=Option(20, "batches of requests", 5),
        requests=Option(3, "requests in a batch"),
        programs=Option([], "files of another program than the mailbot's"),
        seconds=Option(0.0, "duration of an action"),
    )
