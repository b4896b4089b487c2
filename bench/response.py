#!/usr/bin/env python3
"""Measures the core's response: from the last return on in_rosoclingo to the next action on out_rosoclingo.

A master and two core nodes with the mailbot's program, one of them with a journal, run in turns. This process is the
client and the interface layer: it returns each action at once, or after some seconds. So the figures contain only the
core and ROS. The journal is in the folder for temporary files (TMPDIR).

Run it in the built workspace: ./dev exec python3 bench/response.py
"""

import argparse
import contextlib
import os
import queue
import random
import signal
import socket
import statistics
import subprocess
import tempfile
import time

import actionlib
import rosgraph
import rospy
from figures import Figure, parse, write
from rosoclingo.msg import InterfaceIO, ROSoClingoAction, ROSoClingoGoal, TaskPlan

from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.keywords import CORE


class Responder:
    """Returns each action of the core in one namespace, and records the time until the next action."""

    def __init__(self, space, seconds=0.0):
        self.space, self.answered, self._seconds = space, None, seconds
        self.responses, self.clingo = {}, {}  # cycle -> seconds; the core publishes a plan after its actions
        self.messages = queue.Queue()
        self.out = rospy.Publisher(f"/{space}/in_rosoclingo", InterfaceIO, queue_size=10)
        rospy.Subscriber(f"/{space}/out_rosoclingo", InterfaceIO, self.on_action, tcp_nodelay=True)
        rospy.Subscriber(f"/{space}/rosoclingo/task_plan", TaskPlan, self.on_plan)
        self.client, self._goals = actionlib.ActionClient(f"/{space}/rosoclingo", ROSoClingoAction), 0
        self._source = random.Random(1)

    def on_action(self, message):
        if message.interface != CORE:
            self.messages.put((time.perf_counter(), message))

    def on_plan(self, message):
        self.clingo[message.cycle] = message.ground_time + message.solve_time

    def wait(self):
        """Wait until the core is ready."""
        if not self.client.wait_for_server(rospy.Duration(60)):
            raise SystemExit("the core did not start")
        while self.out.get_num_connections() == 0:
            rospy.sleep(0.05)

    @property
    def processor_time(self):
        """Seconds of processor time of the core's process, without its solver."""
        return processor_time(f"/{self.space}/rosoclingo")

    def batch(self, count):
        """Send ``count`` goals at once and return actions until the goals have ended."""
        goals = []
        for _ in range(count):
            self._goals += 1
            start, end = self._source.sample(range(1, 5), 2)
            goals.append(self.client.send_goal(ROSoClingoGoal(f"goal(office{start},office{end},{self._goals})")))
        self.answered = None
        self.run(lambda: all(goal.get_comm_state() == actionlib.CommState.DONE for goal in goals))

    def run(self, done):
        """Return actions until ``done`` returns true."""
        while not done():
            try:
                received, message = self.messages.get(timeout=0.05)
            except queue.Empty:
                self.answered = self.answered if not done() else None
                continue
            if self.answered is not None:
                self.responses[_cycle(message)] = received - self.answered
            time.sleep(self._seconds)
            for text in message.facts:
                action, value, cycle = parse_atom(text).arguments
                self.answered = time.perf_counter()
                self.out.publish(InterfaceIO(message.interface, [f"_return({action},{value},{cycle})"]))


def _cycle(message):
    return parse_atom(message.facts[0]).arguments[2].number


def processor_time(node):
    """Return the seconds of processor time of a node's process."""
    master = rosgraph.Master(rospy.get_name())
    pid = rosgraph.Master(rospy.get_name(), master.lookupNode(node)).getPid()
    with open(f"/proc/{pid}/stat") as file:
        return sum(map(int, file.read().rsplit(")", 1)[1].split()[11:13])) / os.sysconf("SC_CLK_TCK")


def begin(responders, count):
    """Play a first batch with each core, which loads libraries; it is not measured."""
    for responder in responders:
        responder.wait()
        responder.batch(count)
        responder.responses.clear()


def play(responders, batches, count):
    """Run the cores in turns; return the processor time per cycle of each, in ms."""
    before = [responder.processor_time for responder in responders]
    for _ in range(batches):
        for responder in responders:
            responder.batch(count)
    spent = [responder.processor_time - start for responder, start in zip(responders, before)]
    return [1000 * seconds / len(responder.responses) for responder, seconds in zip(responders, spent)]


def report(responder, cycle, words=""):
    """Print and return the figures of one core."""
    times = sorted(1000 * one for one in responder.responses.values())
    share = sum(responder.clingo.get(one, 0.0) for one in responder.responses) / sum(responder.responses.values())
    p99 = times[min(len(times) - 1, int(0.99 * len(times)))]
    median = statistics.median(times)
    print(
        f"{len(times)} responses{words}: median {median:.1f} ms, p99 {p99:.1f} ms, {share:.0%} in clingo; "
        f"{cycle:.1f} ms of processor time a cycle, without the solver"
    )
    return [
        Figure(f"response{words}, median", median, "ms"),
        Figure(f"response{words}, 99 %", p99, "ms"),
        Figure(f"a cycle of the core{words}", cycle, "ms of processor"),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--batches", type=int, default=20, help="batches of requests (default: %(default)s)")
    parser.add_argument("--requests", type=int, default=3, help="requests in a batch (default: %(default)s)")
    parser.add_argument("--programs", nargs="+", metavar="FILE", help="files of another program than the mailbot's")
    parser.add_argument("--seconds", type=float, default=0.0, help="duration of an action (default: %(default)s)")
    options = parse(parser, batches=5)
    port = own_master()
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        for space, journal, wait in (("without", "none", []), ("with", folder, ["--wait"])):
            command = ["roslaunch", *wait, "-p", str(port), "rosoclingo", "core.launch", f"journal:={journal}"]
            command += [f"programs:={list(map(os.path.abspath, options.programs))}"] if options.programs else []
            environment = {**os.environ, "ROS_NAMESPACE": space}
            stack.enter_context(launched(command, environment))
        rospy.init_node("bench_response", disable_signals=True)
        responders = [Responder("without", options.seconds), Responder("with", options.seconds)]
        begin(responders, options.requests)
        cycles = play(responders, options.batches, options.requests)
        found = [*report(responders[0], cycles[0]), *report(responders[1], cycles[1], " with a journal")]
        write(options.json, found)


def own_master():
    """Set the environment to a master on a free port; return the port."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    os.environ.update(ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1")
    return port


@contextlib.contextmanager
def launched(command, environment):
    """Run a command, such as roslaunch, and interrupt it at the end."""
    launch = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        launch.send_signal(signal.SIGINT)
        launch.wait(30)


if __name__ == "__main__":
    main()
