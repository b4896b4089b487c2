#!/usr/bin/env python3
"""The mailbot drives through the office: to every label, cancelled, preempted, to unreachable places."""

import sys
import unittest
from pathlib import Path

import rospy
import rostest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from navigation_helpers import ABORTED, PREEMPTED, SUCCEEDED, Driver, pose_goal


class OfficeDrive(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.driver = Driver()
        cls.labels = rospy.get_param("/labels")

    def test_reaches_every_label_without_contact(self):
        for name in ("office4", "office2", "office3", "office1"):
            label = self.labels[name]
            before = self.driver.feedback
            status, text = self.driver.drive(label["x"], label["y"], label["yaw"])
            self.assertEqual((status, text), (SUCCEEDED, "Goal reached."), name)
            self.assertLess(self.driver.distance(label["x"], label["y"]), 0.2)
            self.assertGreater(self.driver.feedback - before, 10)
        self.assertEqual(self.driver.collisions, [])

    def test_cancelled_goal_stops_the_robot(self):
        self.driver.send(pose_goal(13.9, 0.0))
        self.driver.wait(lambda: self.driver.speed[0] > 0.3)
        self.driver.client.cancel_goal()
        status, text = self.driver.end()
        self.assertEqual((status, text), (PREEMPTED, "The goal was cancelled."))
        self.driver.wait(lambda: self.driver.speed == (0.0, 0.0))

    def test_new_goal_preempts_the_old_one(self):
        first = Driver()
        first.send(pose_goal(13.9, 0.0))
        first.wait(lambda: first.speed[0] > 0.3)
        self.driver.send(pose_goal(5.9, 0.0))
        status, text = first.end()
        self.assertEqual(status, PREEMPTED)
        self.assertIn("another goal was rec", text)  # received; the C++ server says recieved
        self.assertEqual(self.driver.end()[0], SUCCEEDED)
        self.assertLess(self.driver.distance(5.9, 0.0), 0.2)

    def test_goal_in_a_wall_is_aborted_with_reason(self):
        status, text = self.driver.drive(7.93, 3.0)
        self.assertEqual(status, ABORTED)
        self.assertIn("the goal is in an obstacle of the map", text)

    def test_goal_outside_of_building_is_aborted_with_reason(self):
        self.assertIn("off the map", self.driver.drive(100.0, 0.0)[1])

    def test_invalid_quaternion_is_refused(self):
        goal = pose_goal(5.9, 0.0)
        goal.target_pose.pose.orientation.w = 0.0
        goal.target_pose.pose.orientation.z = 0.0
        self.driver.send(goal)
        status, text = self.driver.end()
        self.assertEqual(status, ABORTED)
        self.assertIn("invalid quaternion", text)

    def test_unknown_frame_is_refused(self):
        status, text = self.driver.drive(1.0, 0.0, frame="moon")
        self.assertEqual(status, ABORTED)
        self.assertIn("moon", text)

    def test_goal_in_the_robots_own_frame_is_reached(self):
        x, y, _ = self.driver.pose
        status, _ = self.driver.drive(0.5, 0.0, frame="base_link")
        self.assertEqual(status, SUCCEEDED)
        self.assertLess(abs(self.driver.distance(x, y) - 0.5), 0.25)


if __name__ == "__main__":
    rospy.init_node("office_drive")
    rostest.rosrun("rosoclingo", "office_drive", OfficeDrive, sys.argv)
