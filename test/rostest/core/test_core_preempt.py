#!/usr/bin/env python3
"""With ~preempt the robot stops at once if its goal is cancelled while it drives."""

import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from rosoclingo.msg import InterfaceIO

from rosoclingo.reasoning.keywords import CORE

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client
from interface_helpers import init_node, wait_to_hear
from navigation_helpers import Driver


class CorePreempt(unittest.TestCase):
    def test_cancel_while_driving_stops_the_robot(self):
        office2 = rospy.get_param("/rosoclingo/labels")["office2"]
        commands = []

        def note(message):
            """Record the messages to interfaces, except those that announce the run."""
            if message.interface != CORE:
                commands.extend(message.facts)

        wait_to_hear(rospy.Subscriber("out_rosoclingo", InterfaceIO, note))
        robot, client = Driver(), Client()
        goal = client.send("goal(office3,office2,1)")
        robot.wait(lambda: robot.speed[0] > 0.2)
        goal.cancel()
        status, result = goal.wait()
        self.assertEqual(status, GoalStatus.PREEMPTED, result)
        self.assertEqual(commands[0], "_action_lib(move_base,office2,1)")
        self.assertEqual(commands, ["_action_lib(move_base,office2,1)", "_cancel(move_base,office2,1)"])
        self.assertGreater(abs(robot.pose[0] - office2["x"]), 0.5, "it went all the way")
        robot.wait(lambda: robot.speed == (0.0, 0.0))
        self.assertGreater(abs(robot.pose[0] - office2["x"]), 0.5)


if __name__ == "__main__":
    init_node("core_preempt_test")
    rostest.rosrun("rosoclingo", "core_preempt", CorePreempt, sys.argv)
