"""Two robots: namespaces and frames as in stage_ros, and both pass each other in a corridor."""

import math
import unittest

import rosgraph
import rospy
from interface_helpers import PATIENCE
from nav_msgs.msg import OccupancyGrid, Odometry
from navigation_helpers import SUCCEEDED, Driver, pose_goal
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty
from tf2_msgs.msg import TFMessage


class TwoRobots(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.drivers = [Driver("robot_0/"), Driver("robot_1/")]

    def tearDown(self):
        self.assertEqual([driver.collisions for driver in self.drivers], [[], []])

    def test_topics_are_those_of_stage_ros(self):
        publishers, subscribers, _ = rosgraph.Master(rospy.get_name()).getSystemState()
        offered = {topic for topic, nodes in publishers if "/simulator" in nodes}
        heard = {topic for topic, nodes in subscribers if "/simulator" in nodes}
        names = ("odom", "base_pose_ground_truth", "base_scan")
        expected = {f"/robot_{i}/{name}" for i in (0, 1) for name in names} | {"/clock", "/tf"}
        self.assertEqual(offered - {"/rosout", "/simulator/collisions"}, expected)
        self.assertEqual(heard - {"/clock"}, {"/robot_0/cmd_vel", "/robot_1/cmd_vel"})
        rospy.wait_for_service("/reset_positions", timeout=PATIENCE)

    def test_frames_are_those_of_stage_ros(self):
        for i in (0, 1):
            odom = rospy.wait_for_message(f"robot_{i}/odom", Odometry, timeout=PATIENCE)
            self.assertEqual(
                (odom.header.frame_id, odom.child_frame_id), (f"robot_{i}/odom", f"robot_{i}/base_footprint")
            )
            scan = rospy.wait_for_message(f"robot_{i}/base_scan", LaserScan, timeout=PATIENCE)
            self.assertEqual(scan.header.frame_id, f"robot_{i}/base_laser_link")
            costmap = rospy.wait_for_message(
                f"robot_{i}/move_base/local_costmap/costmap", OccupancyGrid, timeout=PATIENCE
            )
            self.assertEqual(costmap.header.frame_id, f"robot_{i}/odom")
        seen = set()
        chain = ("odom", "base_footprint", "base_link", "base_laser_link")
        wanted = {(f"robot_{i}/{a}", f"robot_{i}/{b}") for i in (0, 1) for a, b in zip(chain, chain[1:])}
        wanted |= {("map", f"robot_{i}/odom") for i in (0, 1)}
        while seen != wanted:
            for t in rospy.wait_for_message("/tf", TFMessage, timeout=PATIENCE).transforms:
                seen.add((t.header.frame_id, t.child_frame_id))
            self.assertLessEqual(seen, wanted)

    def test_robots_pass_each_other(self):
        rospy.ServiceProxy("reset_positions", Empty)()
        anna, bert = self.drivers
        anna.send(pose_goal(13.0, 0.0, 0.0))
        bert.send(pose_goal(2.0, 0.0, math.pi))
        self.assertEqual([driver.end() for driver in self.drivers], [(SUCCEEDED, "Goal reached.")] * 2)
        self.assertLess(anna.distance(13.0, 0.0), 0.2)
        self.assertLess(bert.distance(2.0, 0.0), 0.2)
