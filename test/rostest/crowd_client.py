#!/usr/bin/env python3
"""One client of the crowd: one goal after the other, many of them cancelled; prints how each of them ended, as JSON."""

import json
import queue
import sys

import rospy
from actionlib import ActionClient
from actionlib.action_client import CommState
from crowd_errands import errands
from rosoclingo.msg import ROSoClingoAction, ROSoClingoGoal


class CrowdClient:
    """Sends its errands and notes how they end: number to terminal state and message."""

    def __init__(self, client):
        self._errands = errands(client)
        self._client = ActionClient("rosoclingo", ROSoClingoAction)
        self._client.wait_for_server()
        self.ends = {}

    def run(self):
        """Return when all have ended."""
        for errand in self._errands:
            news = queue.Queue()
            handle = self._client.send_goal(
                ROSoClingoGoal(errand.request),
                lambda handle, news=news: news.put(handle.get_comm_state()),
                lambda *_, news=news: news.put(None),
            )
            self._follow(errand, handle, news)
            self.ends[errand.number] = (handle.get_terminal_state(), handle.get_result().message)

    @staticmethod
    def _follow(errand, handle, news):
        """Wait for the end; the news are states, and None for feedback.

        What the server has not acknowledged is not cancelled: actionlib's client may lose such a goal.
        """
        heard = 0
        for state in iter(news.get, CommState.DONE):
            heard += state is None
            if heard == errand.patience and state in (CommState.PENDING, CommState.ACTIVE, None):
                handle.cancel()


if __name__ == "__main__":
    number = int(rospy.myargv()[1])
    rospy.init_node(f"crowd_client_{number}")
    crowd_client = CrowdClient(number)
    crowd_client.run()
    json.dump(crowd_client.ends, sys.stdout)
