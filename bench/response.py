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
import os
import queue
import random
import subprocess
import tempfile
import time

import actionlib
import rosgraph
import rospy
from figures import Figure, Option, main, quantiles
from ros_system import PATIENCE, System, wait_for
from rosoclingo.msg import InterfaceIO, ROSoClingoAction, ROSoClingoGoal
from std_msgs.msg import String
from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect

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


def view(address, count):
    """Act as ``count`` viewers of a page; print a line as soon as each of them has received the run."""
    os.nice(19)
    asyncio.run(_view(address, count))


async def _view(address, count):
    url, headers = address.replace("http:", "ws:") + "run", {"Origin": address.rstrip("/")}
    sockets = [await websocket_connect(HTTPRequest(url, headers=headers), compression_options={}) for _ in range(count)]
    for socket in sockets:
        await socket.read_message()
    print("all viewers have the run", flush=True)

    async def read(socket):
        while await socket.read_message() is not None:
            pass

    await asyncio.gather(*map(read, sockets))


def measure(options):
    """Yield the figures of a core alone, of one with a journal, and of one with a page unless there are no viewers."""
    programs = [f"programs:={list(map(os.path.abspath, options.programs))}"] if options.programs else []
    spaces = {"alone": "", "journal": " with a journal"}
    if options.viewers:
        spaces["page"] = f" with a page and {options.viewers} viewers"
    with tempfile.TemporaryDirectory() as folder, System() as system:
        for space in spaces:
            journal = folder if space == "journal" else "none"
            system.launch("core.launch", f"journal:={journal}", *programs, namespace=space)
        rospy.init_node("bench_response", disable_signals=True)
        figures = compare(spaces, options.batches, options.requests, options.seconds)
        yield from watched(system, figures, options) if options.viewers else figures


def watched(system, figures, options):
    """Yield figures while viewers watch a page, and the processor time of the page's node."""
    system.start("rosrun", "rosoclingo", "web", "_port:=0", "__name:=web", namespace="page")
    address = rospy.wait_for_message("/page/web/address", String, PATIENCE).data
    viewers = system.call("response", f"view({address!r}, {options.viewers})", stdout=subprocess.PIPE)
    if not viewers.stdout.readline():
        raise SystemExit("the viewers have not received the run")
    before, goals = processor_time("/page/web"), (options.batches + 1) * options.requests
    yield from figures
    spent = 1000 * (processor_time("/page/web") - before)
    yield Figure("the page's node, a goal", spent / goals, "ms of processor")


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        batches=Option(20, "batches of requests", 5),
        requests=Option(3, "requests in a batch"),
        programs=Option([], "files of another program than the mailbot's"),
        seconds=Option(0.0, "duration of an action"),
        viewers=Option(10, "number of the page's viewers; 0: no page"),
    )
