#!/usr/bin/env python3
"""Measures the cost of the web page: the core's response and processor time with a page and viewers, and without.

As in bench/response.py, a master and two core nodes with the mailbot's program run in turns. One core has a page
(rosrun rosoclingo web) with viewers, which connect over WebSockets like browsers. The viewers run in a separate process
with the lowest priority, since real viewers run on other machines. In the end, each viewer must have received all
goals.

Run it in the built workspace: ./dev exec python3 bench/page.py
"""

import argparse
import asyncio
import contextlib
import json
import os
import statistics
import subprocess
import sys
import threading

import rospy
from figures import Figure, parse, write
from response import Responder, begin, launched, own_master, play, processor_time, report
from std_msgs.msg import String
from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect

PATIENCE = 60.0  # s


async def look_on(address, count):
    """Act as ``count`` viewers; print a line when all have received the run, and another for each ended goal."""
    tables = await asyncio.gather(*(_join(address) for _ in range(count)))
    print("joined", flush=True)
    ended = [set() for _ in range(count)]
    printed = 0

    def note(number, changes):
        nonlocal printed
        ended[number].update(key for key, goal in changes.get("goals", ()) if goal["ended"] is not None)
        known = len(set.intersection(*ended))
        if known > printed:
            printed = known
            print(printed, flush=True)

    async def look(number, socket, first):
        note(number, first)
        while True:
            text = await socket.read_message()
            if text is None:
                return
            note(number, json.loads(text))

    await asyncio.gather(*(look(number, *one) for number, one in enumerate(tables)))


async def _join(address):
    headers = {"Origin": address.rstrip("/")}
    request = HTTPRequest(address.replace("http:", "ws:") + "run", headers=headers)
    socket = await websocket_connect(request, compression_options={})
    return socket, json.loads(await socket.read_message())


class Viewers:
    """The process of the viewers, and the lines that it prints."""

    def __init__(self, process):
        self._changed = threading.Condition()
        self.joined, self.ended = False, 0
        threading.Thread(target=self._read, args=(process.stdout,), daemon=True).start()

    def _read(self, lines):
        for line in lines:
            with self._changed:
                self.joined = True
                self.ended = int(line) if line.strip().isdigit() else self.ended
                self._changed.notify_all()

    def wait(self, condition, what):
        """Wait until ``condition`` holds; exit if the viewers have not received ``what`` in time."""
        with self._changed:
            if not self._changed.wait_for(condition, PATIENCE):
                raise SystemExit(f"the viewers have not received {what} within {PATIENCE:g} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--batches", type=int, default=20, help="batches of requests (default: %(default)s)")
    parser.add_argument("--requests", type=int, default=3, help="requests in a batch (default: %(default)s)")
    parser.add_argument("--viewers", type=int, default=10, help="number of viewers (default: %(default)s)")
    parser.add_argument("--look-on", metavar="ADDRESS", help=argparse.SUPPRESS)
    options = parse(parser, batches=5)
    if options.look_on:
        os.nice(19)
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(look_on(options.look_on, options.viewers))
        return
    port = str(own_master())
    with contextlib.ExitStack() as stack:
        for space, wait in (("without", []), ("with", ["--wait"])):
            command = ["roslaunch", *wait, "-p", port, "rosoclingo", "core.launch"]
            stack.enter_context(launched(command, {**os.environ, "ROS_NAMESPACE": space}))
        rospy.init_node("bench_page", disable_signals=True)
        responders = [Responder("without"), Responder("with")]
        begin(responders, options.requests)
        page = ["rosrun", "rosoclingo", "web", "_port:=0", "__name:=web"]
        stack.enter_context(launched(page, {**os.environ, "ROS_NAMESPACE": "with"}))
        address = rospy.wait_for_message("/with/web/address", String, PATIENCE).data
        viewers = stack.enter_context(looking_on(address, options.viewers))
        viewers.wait(lambda: viewers.joined, "the run")
        write(options.json, measure(responders, options, viewers))


def measure(responders, options, viewers):
    """Run both cores; print and return the figures."""
    before = processor_time("/with/web")
    cycles = play(responders, options.batches, options.requests)
    viewers.wait(lambda: viewers.ended >= options.batches * options.requests, "all goals")
    page = 1000 * (processor_time("/with/web") - before) / len(responders[1].responses)
    words = f" with a page and {options.viewers} viewers"
    found = [*report(responders[0], cycles[0]), *report(responders[1], cycles[1], words)]
    medians = [statistics.median(one.responses.values()) for one in responders]
    print(
        f"ratio, with page to without: response {medians[1] / medians[0]:.2f}, "
        f"processor time of the core {cycles[1] / cycles[0]:.2f}; the page's node uses {page:.1f} ms of it a cycle"
    )
    return [*found, Figure("the page's node, a cycle", page, "ms of processor")]


@contextlib.contextmanager
def looking_on(address, count):
    """Run the process of the viewers."""
    command = [sys.executable, __file__, "--look-on", address, "--viewers", str(count)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        yield Viewers(process)
    finally:
        process.terminate()
        process.wait(30)


if __name__ == "__main__":
    main()
