#!/usr/bin/env python3
"""Navigation when things go wrong: doors, obstacles, a lost laser, a robot carried away; and move_base's services."""

import sys
import unittest

import rospy
import rostest
from geometry_msgs.msg import PoseStamped
from move_base_msgs.msg import RecoveryStatus
from nav_msgs.msg import OccupancyGrid, Path
from nav_msgs.srv import GetPlan
from navigation_helpers import ABORTED, SUCCEEDED, Driver, pose_goal
from rosoclingo.srv import PutObstacle, RemoveObstacle, SetDoor
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty


class NavigationFaults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.relaying = True
        cls.relay = rospy.Publisher("relayed_scan", numpy_msg(LaserScan), queue_size=1)
        rospy.Subscriber("base_scan", numpy_msg(LaserScan), lambda scan: cls.relaying and cls.relay.publish(scan))
        cls.recoveries = []
        rospy.Subscriber("/move_base/recovery_status", RecoveryStatus, cls.recoveries.append)
        cls.driver = Driver()
        cls.door = rospy.ServiceProxy("/simulator/set_door", SetDoor)
        cls.plan = rospy.ServiceProxy("/move_base/make_plan", GetPlan)

    def setUp(self):
        for door in ("corridor", "meeting_west", "meeting_east"):
            self.door(door, True)
        rospy.ServiceProxy("reset_positions", Empty)()
        self.driver.wait(lambda: self.driver.distance(1.9, 0.0) < 0.01)
        rospy.ServiceProxy("/move_base/clear_costmaps", Empty)()

    def tearDown(self):
        self.assertEqual(self.driver.collisions, [])

    def test_a_door_closes_on_the_way_and_the_robot_goes_round(self):
        self.driver.send(pose_goal(9.9, 0.0))
        self.driver.wait(lambda: self.driver.pose[0] > 4.0)
        self.assertTrue(self.door("corridor", False).success)
        south = []
        self.driver.wait(lambda: south.append(self.driver.pose[1]) or min(south) < -1.3)
        self.assertEqual(self.driver.end()[0], SUCCEEDED)
        self.assertLess(self.driver.distance(9.9, 0.0), 0.2)

    def test_doors_closed_for_good_end_with_the_reason_and_open_again_it_goes(self):
        self.door("corridor", False)
        self.door("meeting_west", False)
        before = len(self.recoveries)
        status, text = self.driver.drive(9.9, 0.0)
        self.assertEqual(status, ABORTED)
        self.assertIn("blocked by something that is not on the map", text)
        self.assertGreater(len(self.recoveries), before)
        self.door("corridor", True)
        self.assertEqual(self.driver.drive(9.9, 0.0)[0], SUCCEEDED)

    def test_an_obstacle_on_the_goal_and_taken_away(self):
        put = rospy.ServiceProxy("/simulator/put_obstacle", PutObstacle)
        self.assertTrue(put("crate", 5.9, 0.0, 0.3, 0.0, 0.0, 0.0).success)
        status, text = self.driver.drive(5.9, 0.0)
        self.assertEqual(status, ABORTED)
        self.assertIn("not on the map", text)
        rospy.ServiceProxy("/simulator/remove_obstacle", RemoveObstacle)("crate")
        self.assertEqual(self.driver.drive(5.9, 0.0)[0], SUCCEEDED)

    def test_a_lost_laser_stops_the_robot_and_ends_the_goal(self):
        self.driver.send(pose_goal(13.9, 0.0))
        self.driver.wait(lambda: self.driver.speed[0] > 0.3)
        type(self).relaying = False
        try:
            self.driver.wait(lambda: self.driver.speed == (0.0, 0.0))
            self.assertLess(self.driver.pose[0], 10.0)
            status, text = self.driver.end()
        finally:
            type(self).relaying = True
        self.assertEqual(status, ABORTED)
        self.assertIn("laser is lost", text)
        self.assertEqual(self.driver.drive(2.5, 0.0)[0], SUCCEEDED)

    def test_a_reset_on_the_way(self):
        self.driver.send(pose_goal(9.9, 0.0))
        self.driver.wait(lambda: self.driver.pose[0] > 4.0)
        rospy.ServiceProxy("reset_positions", Empty)()
        self.assertEqual(self.driver.end()[0], SUCCEEDED)
        self.assertLess(self.driver.distance(9.9, 0.0), 0.2)

    def ask(self, x, y, frame="map"):
        start, goal = PoseStamped(), PoseStamped()
        start.header.frame_id, goal.header.frame_id = "map", frame
        start.pose.position.x, goal.pose.position.x, goal.pose.position.y = 1.9, x, y
        return self.plan(start, goal, 0.0).plan

    def test_make_plan(self):
        plan = self.ask(9.9, 0.0)
        self.assertEqual(plan.header.frame_id, "map")
        first, last = plan.poses[0].pose.position, plan.poses[-1].pose.position
        self.assertAlmostEqual(first.x, 1.9, delta=0.05)
        self.assertAlmostEqual(last.x, 9.9, delta=0.05)
        self.assertEqual(self.ask(7.93, 3.0).poses, [])
        self.assertEqual(self.ask(1.0, 0.0, "moon").poses, [])

    def test_what_is_shown(self):
        costmap = rospy.wait_for_message("/move_base/global_costmap/costmap", OccupancyGrid, timeout=60)
        self.assertEqual((costmap.info.width, costmap.info.height), (348, 208))
        self.assertTrue({0, 99, 100, -1} <= set(costmap.data))
        local = rospy.wait_for_message("/move_base/local_costmap/costmap", OccupancyGrid, timeout=60)
        self.assertLessEqual(local.info.width, 121)
        shown = []
        rospy.Subscriber("/move_base/GridPlanner/plan", Path, shown.append)
        current = []
        rospy.Subscriber("/move_base/current_goal", PoseStamped, current.append)
        simple = rospy.Publisher("move_base_simple/goal", PoseStamped, queue_size=1)
        goal = pose_goal(5.9, 0.0).target_pose
        self.driver.wait(lambda: simple.get_num_connections() > 0)
        simple.publish(goal)
        self.driver.wait(lambda: self.driver.distance(5.9, 0.0) < 0.2)
        self.assertTrue(current)
        self.assertTrue(shown)


if __name__ == "__main__":
    rospy.init_node("navigation_faults")
    rostest.rosrun("rosoclingo", "navigation_faults", NavigationFaults, sys.argv)
