#!/usr/bin/env python3
"""Times the core's response: from the last return on in_rosoclingo to the next action on out_rosoclingo.

A real master and a real core node with the mailbot program; this process is the client and the interface layer, which
answers each action at once, so that the figures are the core's and ROS's own. To be run in the built workspace:
./dev exec python3 bench/response.py
"""

import argparse
import os
import queue
import random
import signal
import socket
import statistics
import subprocess
import time

import actionlib
import rospy
from figures import Figure, parse, write
from rosoclingo.msg import InterfaceIO, ROSoClingoAction, ROSoClingoGoal, TaskPlan

from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.keywords import CORE


class Responder:
    """Answers each action at once and notes when the next one comes."""

    def __init__(self):
        self.answered = None
        self.responses, self.clingo = {}, {}  # cycle -> seconds; the plan is told after its actions
        self.messages = queue.Queue()
        self.out = rospy.Publisher("in_rosoclingo", InterfaceIO, queue_size=10)
        rospy.Subscriber("out_rosoclingo", InterfaceIO, self.on_action, tcp_nodelay=True)
        rospy.Subscriber("rosoclingo/task_plan", TaskPlan, self.on_plan)

    def on_action(self, message):
        if message.interface != CORE:
            self.messages.put((time.perf_counter(), message))

    def on_plan(self, message):
        self.clingo[message.cycle] = message.ground_time + message.solve_time

    def run(self, done):
        """Answer until ``done`` says so."""
        while not done():
            try:
                received, message = self.messages.get(timeout=0.05)
            except queue.Empty:
                self.answered = self.answered if not done() else None
                continue
            if self.answered is not None:
                self.responses[_cycle(message)] = received - self.answered
            for text in message.facts:
                action, value, cycle = parse_atom(text).arguments
                self.answered = time.perf_counter()
                self.out.publish(InterfaceIO(message.interface, [f"_return({action},{value},{cycle})"]))


def _cycle(message):
    return parse_atom(message.facts[0]).arguments[2].number


def play(batches, batch):
    responder = Responder()
    client = actionlib.ActionClient("rosoclingo", ROSoClingoAction)
    if not client.wait_for_server(rospy.Duration(30)):
        raise SystemExit("the core did not start")
    while responder.out.get_num_connections() == 0:
        rospy.sleep(0.05)
    source, number = random.Random(1), 0
    for _ in range(batches):
        goals = []
        for _ in range(batch):
            number += 1
            start, end = source.sample(range(1, 5), 2)
            goals.append(client.send_goal(ROSoClingoGoal(f"goal(office{start},office{end},{number})")))
        responder.answered = None
        responder.run(lambda goals=goals: all(g.get_comm_state() == actionlib.CommState.DONE for g in goals))
    return responder


def report(responder):
    """Print the figures and return them."""
    times = sorted(1000 * one for one in responder.responses.values())
    share = sum(responder.clingo.get(cycle, 0.0) for cycle in responder.responses) / sum(responder.responses.values())
    p99 = times[min(len(times) - 1, int(0.99 * len(times)))]
    median = statistics.median(times)
    print(f"{len(times)} responses: median {median:.1f} ms, p99 {p99:.1f} ms, {share:.0%} in clingo")
    return [Figure("response, median", median, "ms"), Figure("response, 99 %", p99, "ms")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--batches", type=int, default=20, help="batches of requests (default: %(default)s)")
    parser.add_argument("--requests", type=int, default=3, help="requests in a batch (default: %(default)s)")
    options = parse(parser, batches=5)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    os.environ.update(ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1")
    command = ["roslaunch", "-p", str(port), "rosoclingo", "core.launch"]
    launch = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        rospy.init_node("bench_response", disable_signals=True)
        write(options.json, report(play(options.batches, options.requests)))
    finally:
        launch.send_signal(signal.SIGINT)
        launch.wait(30)


if __name__ == "__main__":
    main()
