#!/usr/bin/env python3
"""One client of the crowd: all its goals at once, many of them cancelled; prints how each of them ended, as JSON.

It reports its connection, and begins on command.
"""

import collections
import json
import queue
import sys
from pathlib import Path

import rospy
from actionlib import ActionClient
from actionlib.action_client import CommState
from crowd_errands import errands
from rosoclingo.msg import ROSoClingoAction, ROSoClingoGoal

from rosoclingo.common.action_clients import cancel_goal

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from interface_helpers import init_node, wait_for_server


class CrowdClient:
    """Sends its errands and records their ends: number to terminal state and message."""

    def __init__(self, *kind):
        self._errands = errands(*kind)
        self._client = ActionClient("rosoclingo", ROSoClingoAction)
        wait_for_server(self._client)
        self.ends = {}

    def run(self):
        """Return once all have ended."""
        news = queue.Queue()
        handles = [self._send(errand, news) for errand in self._errands]
        heard = collections.Counter()
        while len(self.ends) < len(handles):
            number, state = news.get()
            errand, handle = handles[number]
            if state == CommState.DONE:
                self.ends[errand.number] = (handle.get_terminal_state(), handle.get_result().message)
                continue
            heard[number] += state is None
            if heard[number] == errand.patience and state in (CommState.PENDING, CommState.ACTIVE, None):
                cancel_goal(self._client, handle)

    def _send(self, errand, news):
        """Send an errand and return its handle; the news are the errand's place and states, None for feedback."""
        number = self._errands.index(errand)
        handle = self._client.send_goal(
            ROSoClingoGoal(errand.request),
            lambda handle: news.put((number, handle.get_comm_state())),
            lambda *_: news.put((number, None)),
        )
        return errand, handle


if __name__ == "__main__":
    number, offices, cancels, goals = map(int, rospy.myargv()[1:])
    init_node(f"crowd_client_{number}")
    crowd_client = CrowdClient(number, offices, bool(cancels), goals)
    print("connected", flush=True)
    sys.stdin.readline()
    crowd_client.run()
    json.dump(crowd_client.ends, sys.stdout)
