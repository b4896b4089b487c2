#!/usr/bin/env python3
"""Two robots: namespaces and frames as in stage_ros, and both pass each other in a corridor."""

import math
import sys
import unittest
from pathlib import Path

import rosgraph
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped, Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from rosoclingo.srv import SetRobotPose
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty
from tf2_msgs.msg import TFMessage

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from interface_helpers import PATIENCE, init_node, wait_until
from navigation_helpers import PREEMPTED, SUCCEEDED, Driver, pose_goal


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

    def test_command_moves_one_robot_only(self):
        rospy.ServiceProxy("reset_positions", Empty)()
        command, twist = rospy.Publisher("robot_1/cmd_vel", Twist, queue_size=1), Twist()
        twist.angular.z = 1.0
        mover, other = self.drivers[1], self.drivers[0]
        mover.wait(lambda: command.publish(twist) or abs(mover.speed[1]) > 0.5)
        self.assertEqual(other.speed, (0.0, 0.0))

    def test_robots_pass_each_other(self):
        rospy.ServiceProxy("reset_positions", Empty)()
        anna, bert = self.drivers
        anna.send(pose_goal(13.0, 0.0, 0.0))
        bert.send(pose_goal(2.0, 0.0, math.pi))
        self.assertEqual([driver.end() for driver in self.drivers], [(SUCCEEDED, "Goal reached.")] * 2)
        self.assertLess(anna.distance(13.0, 0.0), 0.2)
        self.assertLess(bert.distance(2.0, 0.0), 0.2)

    def test_walkers_do_not_stop_a_moved_robot(self):
        """Concurrent goals, and a person who walks to and fro. The last test: odometry is wrong afterwards."""
        rospy.ServiceProxy("reset_positions", Empty)()
        anna, bert = self.drivers
        legs = rospy.Publisher("robot_1/cmd_vel", Twist, queue_size=1)
        truth = rospy.Subscriber("robot_1/base_pose_ground_truth", Odometry, lambda one: legs.publish(stroll(one)))
        anna.send(pose_goal(8.0, 0.0))
        anna.wait(lambda: anna.speed[0] > 0.2)
        rival = Driver("robot_0/")
        rival.send(pose_goal(1.9, 0.0))
        self.assertEqual(anna.end()[0], PREEMPTED)
        rival.wait(lambda: rival.speed[0] > 0.1)
        rival.client.cancel_goal()
        rival.wait(lambda: rival.speed == (0.0, 0.0))
        self.assertTrue(rospy.ServiceProxy("simulator/set_pose", SetRobotPose)("anna", 4.0, -0.2, 2.0).success)
        message = PoseWithCovarianceStamped()
        message.header.frame_id = "map"
        message.pose.pose = pose_goal(4.0, -0.2, 2.0).target_pose.pose
        lost = rospy.Publisher("robot_0/initialpose", PoseWithCovarianceStamped, queue_size=1)
        wait_until(lost.get_num_connections, "the localisation to listen")
        lost.publish(message)
        wait_until(
            lambda: is_near(rospy.wait_for_message("robot_0/amcl_pose", type(message)), message), "it to be found"
        )
        self.assertEqual(rival.drive(8.0, 0.0), (SUCCEEDED, "Goal reached."))
        self.assertLess(rival.distance(8.0, 0.0), 0.2)
        truth.unregister()
        bert.wait(lambda: bert.speed[0] < 0.01)


def is_near(found, message):
    """Return whether two poses are next to each other."""
    a, b = found.pose.pose.position, message.pose.pose.position
    return math.hypot(a.x - b.x, a.y - b.y) < 0.05


def stroll(message):
    """Return the next step of a person who walks between x 9 m and 13 m, looking along the corridor."""
    twist, turned = Twist(), message.pose.pose.orientation
    yaw, x = 2.0 * math.atan2(turned.z, turned.w), message.pose.pose.position.x
    stroll.direction = math.pi if x > 12.5 else 0.0 if x < 9.5 else stroll.direction
    error = math.remainder(stroll.direction - yaw, 2.0 * math.pi)
    twist.angular.z = max(-1.5, min(1.5, 2.0 * error))
    twist.linear.x = 0.4 if abs(error) < 0.2 else 0.0
    return twist


stroll.direction = math.pi


if __name__ == "__main__":
    init_node("two_robots")
    rostest.rosrun("rosoclingo", "two_robots", TwoRobots, sys.argv)
