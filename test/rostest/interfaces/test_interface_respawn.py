#!/usr/bin/env python3
"""An interface node that is killed in the middle of an action is started again, and the plan goes on."""

import os
import signal
import sys
import unittest
from pathlib import Path

import rostest
from actionlib import ActionClient, GoalStatus
from actionlib.action_client import CommState
from move_base_msgs.msg import MoveBaseAction
from rosoclingo.msg import DeliverAction, PickupAction, ROSoClingoAction, ROSoClingoGoal

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from interface_helpers import CoreSide, Server, init_node, process_of, wait_for_server, wait_until


class InterfaceRespawn(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        init_node("robot_side")
        cls.move_base = Server("move_base", MoveBaseAction)
        cls.pickup = Server("pickup", PickupAction)
        cls.deliver = Server("deliver", DeliverAction)
        cls.client = ActionClient("rosoclingo", ROSoClingoAction)
        wait_for_server(cls.client)
        cls.returns = CoreSide()
        cls.returns.wait_for("move_base_interface")

    def end(self, handle):
        wait_until(lambda: handle.get_comm_state() == CommState.DONE, "the goal to end")
        return handle.get_terminal_state()

    def test_killed_and_started_again(self):
        handle = self.client.send_goal(ROSoClingoGoal("goal(office1,office2,1)"))
        goal, readers = self.pickup.accept(), self.pickup.readers()
        os.kill(process_of("pickup_interface"), signal.SIGKILL)
        self.pickup.wait_for_new_reader("pickup_interface", readers)
        goal.set_succeeded()  # the core has asked the new node again, which has found the goal at its server
        self.move_base.accept()  # the core has heard the new node
        os.kill(process_of("move_base_interface"), signal.SIGINT)
        self.move_base.cancelled().set_canceled()
        told = self.returns.receive()
        if told == ["_return(pickup,1,1)"]:  # the new node may have told it before it was connected to the test
            told = self.returns.receive()
        self.assertEqual(told, ["_return(move_base,interface_lost,2)"])
        self.move_base.accept().set_succeeded()  # planned anew
        self.deliver.accept().set_succeeded()
        self.assertEqual(self.end(handle), GoalStatus.SUCCEEDED)


if __name__ == "__main__":
    rostest.rosrun("rosoclingo", "interface_respawn", InterfaceRespawn, sys.argv)
