#!/usr/bin/env python3
"""Plugins by class path: they drive the robot, have their own parameters and topics, and fail only for their goal."""

import pathlib
import sys
import threading
import unittest

import rospy
import rostest
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import RecoveryStatus
from nav_msgs.msg import OccupancyGrid, Path
from nav_msgs.srv import GetPlan
from std_srvs.srv import SetBool

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

from interface_helpers import init_node, wait_to_hear, wait_until
from navigation_helpers import ABORTED, PREEMPTED, SUCCEEDED, Driver, pose_goal


class NavigationPlugins(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plans, cls.local_plans, cls.recoveries = [], [], []
        links = (
            rospy.Subscriber("move_base/Surveyor/plan", Path, cls.plans.append),
            rospy.Subscriber("move_base/Stroller/local_plan", Path, cls.local_plans.append),
            rospy.Subscriber("move_base/recovery_status", RecoveryStatus, cls.recoveries.append),
        )
        cls.driver = Driver()
        wait_to_hear(*links)

    def tearDown(self):
        self.assertEqual(self.driver.collisions, [])

    def test_planners_drive_the_robot(self):
        speeds, near = [], []
        self.driver.send(pose_goal(8.5, 0.0))
        self.driver.wait(
            lambda: (
                speeds.append(self.driver.speed[0])
                or near.append(self.driver.distance(5.0, 0.6))
                or self.driver.distance(8.5, 0.0) < 0.1
            )
        )
        self.assertEqual(self.driver.end()[0], SUCCEEDED)
        self.assertLess(max(speeds), 0.45)
        self.assertGreater(max(speeds), 0.3)
        self.assertLess(min(near), 0.5)
        self.assertTrue(self.plans)
        self.assertEqual(self.local_plans[-1].header.frame_id, "odom")

    def test_global_planner_error_costs_only_its_goal(self):
        status, text = self.driver.drive(14.5, 0.0)
        self.assertEqual(status, ABORTED)
        self.assertIn("the surveyor has lost his chart", text)
        x, y, _ = self.driver.pose
        self.assertEqual(self.driver.drive(x, y)[0], SUCCEEDED)

    def test_velocity_that_is_no_number_costs_only_its_goal(self):
        self.driver.drive(2.5, 0.0)
        status, text = self.driver.drive(0.9, 0.0)
        self.assertEqual(status, ABORTED)
        self.assertIn("not finite", text)
        self.driver.wait(lambda: self.driver.speed == (0.0, 0.0))

    def test_recovery_is_the_listed_one(self):
        before = len(self.recoveries)
        status, text = self.driver.drive(13.5, 0.0)
        self.assertEqual(status, ABORTED)
        self.assertIn("blocked by something that is not on the map", text)
        self.assertEqual([status.recovery_behavior_name for status in self.recoveries[before:]], ["wait_a_bit"])
        self.assertEqual(self.recoveries[-1].total_number_of_recoveries, 1)

    def test_make_plan_asks_the_planner_and_survives_it(self):
        start, goal = PoseStamped(), PoseStamped()
        start.header.frame_id = goal.header.frame_id = "map"
        start.pose.position.x = 1.9
        for service in ("move_base/make_plan", "move_base/Surveyor/make_plan"):
            plan = rospy.ServiceProxy(service, GetPlan)
            goal.pose.position.x = 8.5
            points = [pose.pose.position for pose in plan(start, goal, 0.0).plan.poses]
            self.assertTrue(any(abs(p.x - 5.0) < 0.2 and abs(p.y - 0.6) < 0.2 for p in points))
            goal.pose.position.x = 14.5
            self.assertEqual(plan(start, goal, 0.0).plan.poses, [])

    def test_walls_are_in_place_although_scans_are_late(self):
        for x, y, yaw in ((4.0, 0.0, 3.0), (2.0, 0.0, 0.0), (4.0, 0.3, -2.0)):
            self.assertEqual(self.driver.drive(x, y, yaw)[0], SUCCEEDED)
        static = rospy.wait_for_message("map", OccupancyGrid).data
        seen = rospy.wait_for_message("move_base/global_costmap/costmap", OccupancyGrid).data
        self.assertLess(sum(new == 100 != old for old, new in zip(static, seen)), 10)

    def test_endless_planning_can_be_cancelled_and_blocks_nothing(self):
        self.driver.send(pose_goal(12.2, 0.0))
        wait_until(lambda: rospy.has_param("/looks_for_chart"), "the planner to be busy")
        self.driver.client.cancel_goal()
        self.assertEqual(self.driver.end()[0], PREEMPTED)
        x, y, _ = self.driver.pose
        self.assertEqual(self.driver.drive(x, y)[0], SUCCEEDED)
        self.check_that_the_robot_is_driven_on()

    def check_that_the_robot_is_driven_on(self):
        """Check this during planning, here for a service."""
        self.driver.drive(2.5, 0.0)
        rospy.delete_param("/looks_for_chart")  # of the previous test
        pause, answers = rospy.ServiceProxy("simulator/pause", SetBool), []
        self.driver.send(pose_goal(8.5, 0.0))
        self.driver.wait(lambda: self.driver.speed[0] > 0.2)
        asker = threading.Thread(target=lambda: answers.append(ask_for_plan("move_base/make_plan", 12.2)))
        pause(True)
        asker.start()
        wait_until(lambda: rospy.has_param("/looks_for_chart"), "the planner to be busy")
        pause(False)
        self.assertEqual(self.driver.end()[0], SUCCEEDED)
        self.assertEqual(answers, [])
        rospy.set_param("/chart", "found")
        asker.join(60.0)
        self.assertTrue(answers[0].poses)
        self.assertEqual(self.driver.drive(2.5, 0.0)[0], SUCCEEDED)


def ask_for_plan(service, x):
    """Return make_plan's answer for the path along the corridor to x (m)."""
    start, goal = PoseStamped(), PoseStamped()
    start.header.frame_id = goal.header.frame_id = "map"
    start.pose.position.x, goal.pose.position.x = 1.9, x
    return rospy.ServiceProxy(service, GetPlan)(start, goal, 0.0).plan


if __name__ == "__main__":
    init_node("navigation_plugins")
    rostest.rosrun("rosoclingo", "navigation_plugins", NavigationPlugins, sys.argv)
