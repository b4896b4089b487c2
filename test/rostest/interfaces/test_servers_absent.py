#!/usr/bin/env python3
"""A goal for which a server is absent ends with the reason; the core goes on and serves it when the server is there."""

import sys
import unittest
from pathlib import Path

import rostest
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction
from rosoclingo.msg import DeliverAction, PickupAction

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client
from interface_helpers import Server, init_node


class ServersAbsent(unittest.TestCase):
    def test_absent_and_then_there(self):
        client = Client()
        message = client.send("goal(office1,office2,1)").ends_as(GoalStatus.ABORTED)
        self.assertIn("package 1 could not be picked up at office1: server_lost", message)
        servers = [
            Server("pickup", PickupAction),
            Server("move_base", MoveBaseAction),
            Server("deliver", DeliverAction),
        ]
        again = client.send("goal(office1,office2,1)")
        for server in servers:
            server.accept().set_succeeded()
        again.ends_as(GoalStatus.SUCCEEDED)


if __name__ == "__main__":
    init_node("servers_absent_test")
    rostest.rosrun("rosoclingo", "servers_absent", ServersAbsent, sys.argv)
