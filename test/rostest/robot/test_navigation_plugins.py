"""Plugins by class path: they drive the robot, have their own parameters and topics, and fail only for their goal."""

import unittest

import rospy
from interface_helpers import wait_to_hear, wait_until
from move_base_msgs.msg import RecoveryStatus
from nav_msgs.msg import OccupancyGrid, Path
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

    def test_walls_are_in_place_although_scans_are_late(self):
        for x, y, yaw in ((4.0, 0.0, 3.0), (2.0, 0.0, 0.0), (4.0, 0.3, -2.0)):
            self.assertEqual(self.driver.drive(x, y, yaw)[0], SUCCEEDED)
        static = rospy.wait_for_message("map", OccupancyGrid).data
        seen = rospy.wait_for_message("move_base/global_costmap/costmap", OccupancyGrid).data
        self.assertLess(sum(new == 100 != old for old, new in zip(static, seen)), 10)

    def test_endless_planning_can_be_cancelled(self):
        self.driver.send(pose_goal(12.2, 0.0))
        wait_until(lambda: rospy.has_param("/looks_for_chart"), "the planner to be busy")
        self.driver.client.cancel_goal()
        self.assertEqual(self.driver.end()[0], PREEMPTED)
        x, y, _ = self.driver.pose
        self.assertEqual(self.driver.drive(x, y)[0], SUCCEEDED)
