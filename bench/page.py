#!/usr/bin/env python3
"""Measures the cost of the web page: the core's response and processor time with a page and viewers, and without.

As in bench/response.py, two core nodes with the mailbot's program run in turns. One core has a page (rosrun rosoclingo
web) with viewers, which connect over WebSockets like browsers. The viewers run in a separate process with the lowest
priority, since real viewers run on other machines. In the end, each viewer must have received all goals.

Run it in the built workspace: ./dev exec python3 bench/page.py
"""

import asyncio
import json
import os
import subprocess
import threading

import rospy
from figures import Figure, Option, main
from response import compare, processor_time
from ros_system import PATIENCE, System, wait_for
from std_msgs.msg import String
from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect


def view(address, count):
    """Act as ``count`` viewers; print for each ended goal of a viewer the number of goals that have ended for all."""
    os.nice(19)
    asyncio.run(_view(address, [set() for _ in range(count)]))


async def _view(address, viewers):
    async def look(ended):
        request = HTTPRequest(address.replace("http:", "ws:") + "run", headers={"Origin": address.rstrip("/")})
        socket = await websocket_connect(request, compression_options={})
        while True:
            text = await socket.read_message()
            if text is None:
                return
            goals = json.loads(text).get("goals", ())
            ended.update(key for key, goal in goals if goal["ended"] is not None)
            print(len(set.intersection(*viewers)), flush=True)

    await asyncio.gather(*map(look, viewers))


class Viewers:
    """The process of the viewers, and the number of goals that all of them have received as ended."""

    def __init__(self, process):
        self.messages = self.ended = 0
        threading.Thread(target=self._read, args=(process.stdout,), daemon=True).start()

    def _read(self, lines):
        for line in lines:
            self.messages, self.ended = self.messages + 1, int(line)


def measure(options):
    """Yield the figures of a core without a page and of one with it."""
    with System() as system:
        for space in ("without", "with"):
            system.launch("core.launch", namespace=space)
        rospy.init_node("bench_page", disable_signals=True)
        system.start("rosrun", "rosoclingo", "web", "_port:=0", "__name:=web", namespace="with")
        address = rospy.wait_for_message("/with/web/address", String, PATIENCE).data
        call = f"view({address!r}, {options.viewers})"
        viewers = Viewers(system.call("page", call, stdout=subprocess.PIPE, text=True))
        wait_for(lambda: viewers.messages >= options.viewers, "the run of each viewer")
        before, words = processor_time("/with/web"), f" with a page and {options.viewers} viewers"
        yield from compare({"without": "", "with": words}, options.batches, options.requests)
        goals = (options.batches + 1) * options.requests
        wait_for(lambda: viewers.ended >= goals, "all goals of each viewer")
        spent = 1000 * (processor_time("/with/web") - before)
        yield Figure("the page's node, a goal", spent / goals, "ms of processor")


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        batches=Option(20, "batches of requests", 5),
        requests=Option(3, "requests in a batch"),
        viewers=Option(10, "number of viewers"),
    )
