#!/usr/bin/env python3
"""Robots that cannot drive: progress_timeout, oscillation_timeout and recovery_behavior_enabled of move_base."""

import sys
import unittest
from pathlib import Path

import rospy
import rostest
from move_base_msgs.msg import RecoveryStatus

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from interface_helpers import init_node, wait_to_hear
from navigation_helpers import ABORTED, Driver, pose_goal


class NavigationStuck(unittest.TestCase):
    def drive(self, robot, x):
        """Send a robot somewhere; return its goal's text, the duration (simulated s) and the attempted recoveries."""
        driver, recoveries = Driver(robot), []
        subscriber = rospy.Subscriber(robot + "move_base/recovery_status", RecoveryStatus, recoveries.append)
        wait_to_hear(subscriber)
        begin = rospy.get_time()
        driver.send(pose_goal(x, 0.0))
        status, text = driver.end()
        self.assertEqual(status, ABORTED)
        self.assertEqual(driver.collisions, [])
        return text, rospy.get_time() - begin, [status.recovery_behavior_name for status in recoveries]

    def test_no_progress_is_reported_after_all_recoveries_failed(self):
        text, took, recoveries = self.drive("robot_0/", 3.9)
        self.assertRegex(
            text, r"Even after executing recovery behaviors: the remaining path has not become shorter for \d+ s"
        )
        series = ["conservative_reset", "rotate_recovery", "aggressive_reset", "rotate_recovery"]
        self.assertEqual(recoveries[-4:], series)  # a reset can shorten the path: progress
        self.assertGreater(took, 5 * 4.0)
        self.assertLess(took, 150.0)

    def test_oscillation_is_reported_at_once_without_recovery(self):
        text, took, recoveries = self.drive("robot_1/", 7.9)
        self.assertRegex(text, r"Robot is oscillating.*the robot moved less than 0.3 m in \d+ s")
        self.assertEqual(recoveries, [])
        self.assertGreater(took, 4.0)
        self.assertLess(took, 120.0)


if __name__ == "__main__":
    init_node("navigation_stuck")
    rostest.rosrun("rosoclingo", "navigation_stuck", NavigationStuck, sys.argv)
