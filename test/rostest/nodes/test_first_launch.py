#!/usr/bin/env python3
"""With an empty cache of compiled code the first goal of the first launch succeeds, and the delay is explained."""

import os
import shutil
import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from rosgraph_msgs.msg import Log

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client

LIMIT = 500.0  # seconds of wall time: a minute of computing, on any busy machine


class FirstLaunch(unittest.TestCase):
    def test_goal_sent_at_once_succeeds(self):
        said = []
        rospy.Subscriber("/rosout", Log, lambda message: said.append((message.name, message.msg)), queue_size=None)
        goal = Client("rosoclingo").send("goal(office1,office2,3)")
        status, result = goal.wait(LIMIT)
        log = "\n".join(": ".join(one) for one in said)
        self.assertEqual(status, GoalStatus.SUCCEEDED, f"{result}\n{log}")
        self.assertIn("/move_base: compiling navigation once", log)
        self.assertIn("/move_base_interface: move_base: waiting for the action server move_base to start", log)
        self.assertNotIn("server_lost", log)
        self.assertTrue(os.listdir(self.folder), "nothing was kept")


if __name__ == "__main__":
    FirstLaunch.folder = rospy.myargv()[1]
    rospy.init_node("first_launch_test")
    try:
        rostest.rosrun("rosoclingo", "first_launch", FirstLaunch, sys.argv)
    finally:
        shutil.rmtree(FirstLaunch.folder, ignore_errors=True)
