#!/usr/bin/env python3
"""A goal ends with the reason while servers are absent; an interface that is killed restarts and serves."""

import os
import signal
import sys
import unittest
from pathlib import Path

import rostest
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction
from rosoclingo.msg import DeliverAction, PickupAction

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client
from interface_helpers import CoreSide, Server, init_node, process_of

GOAL = "goal(office1,office2,1)"


class InterfaceRespawn(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        init_node("robot_side")
        cls.client = Client()
        cls.absent = cls.client.send(GOAL).ends_as(GoalStatus.ABORTED)
        cls.move_base = Server("move_base", MoveBaseAction)
        cls.pickup = Server("pickup", PickupAction)
        cls.deliver = Server("deliver", DeliverAction)
        cls.returns = CoreSide()
        cls.returns.wait_for("move_base_interface")

    def test_goal_without_servers_is_aborted(self):
        self.assertIn("package 1 could not be picked up at office1: server_lost", self.absent)

    def test_interface_is_killed_and_restarted(self):
        sent = self.client.send(GOAL)
        goal, readers = self.pickup.accept(), self.pickup.readers()
        os.kill(process_of("pickup_interface"), signal.SIGKILL)
        self.pickup.wait_for_new_reader("pickup_interface", readers)
        goal.set_succeeded()  # the core has asked the new node again, which has found the goal at its server
        self.move_base.accept()  # the core is connected with the new node
        os.kill(process_of("move_base_interface"), signal.SIGINT)
        self.move_base.cancelled().set_canceled()
        reported = self.returns.receive()
        if reported[0].startswith(
            "_return(pickup,1,"
        ):  # the new node perhaps sent it before it was connected to the test
            reported = self.returns.receive()
        self.assertRegex(reported[0], r"^_return\(move_base,interface_lost,\d+\)$")
        self.move_base.accept().set_succeeded()  # replanned
        self.deliver.accept().set_succeeded()
        sent.ends_as(GoalStatus.SUCCEEDED)


if __name__ == "__main__":
    rostest.rosrun("rosoclingo", "interface_respawn", InterfaceRespawn, sys.argv)
