"""The simulator's topics and services: rates, frames, watchdog, pause and step, doors, obstacles, poses, reset."""

import math
import threading
import unittest

import rospy
import tf2_ros
from geometry_msgs.msg import Twist, Vector3
from interface_helpers import PATIENCE, kill, wait_to_hear, wait_until
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from rosoclingo.srv import PutObstacle, RemoveObstacle, SetDoor, SetRobotPose, SetSpeed, StepSimulation
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String
from std_srvs.srv import Empty, SetBool
from tf2_msgs.msg import TFMessage

START = (1.9, 0.0)


class Stamps:
    """Counts the messages of a topic and keeps the last one."""

    def __init__(self, topic, kind):
        self.changed, self.messages = threading.Condition(), []
        self.subscriber = rospy.Subscriber(topic, kind, self._take, queue_size=1000)

    def _take(self, message):
        with self.changed:
            self.messages.append(message)
            self.changed.notify_all()

    def wait(self, condition, limit=PATIENCE):
        with self.changed:
            start = len(self.messages)
            if not self.changed.wait_for(lambda: condition(self.messages[start:]), timeout=limit):
                raise AssertionError(f"nothing happened within {limit} s")
            return self.messages[start:]


class SimulatorTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.odom, cls.truth = Stamps("odom", Odometry), Stamps("base_pose_ground_truth", Odometry)
        cls.scan, cls.clock = Stamps("base_scan", LaserScan), Stamps("/clock", Clock)
        cls.transforms = Stamps("/tf", TFMessage)
        cls.collisions = Stamps("/simulator/collisions", String)
        cls.buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.buffer)
        cls.command = rospy.Publisher("cmd_vel", Twist, queue_size=10)
        cls.pause, cls.step = cls.service("pause", SetBool), cls.service("step", StepSimulation)
        cls.place, cls.door = cls.service("set_pose", SetRobotPose), cls.service("set_door", SetDoor)
        cls.put, cls.remove = cls.service("put_obstacle", PutObstacle), cls.service("remove_obstacle", RemoveObstacle)
        topics = (cls.odom, cls.truth, cls.scan, cls.clock, cls.transforms, cls.collisions)
        wait_to_hear(*(one.subscriber for one in topics))
        for one in topics[:-1]:
            one.wait(len)

    @staticmethod
    def service(name, kind):
        rospy.wait_for_service("/simulator/" + name, timeout=PATIENCE)
        return rospy.ServiceProxy("/simulator/" + name, kind)

    def setUp(self):
        rospy.ServiceProxy("reset_positions", Empty)()

    def drive_until(self, condition, v=0.5, w=0.0):
        """Command a velocity with every pose until one satisfies a condition."""
        twist = Twist()
        twist.linear.x, twist.angular.z = v, w

        def check(messages):
            self.command.publish(twist)
            return messages and condition(messages[-1])

        return self.truth.wait(check)[-1]

    def test_rates_are_ten_per_simulated_second(self):
        for stamps in (self.odom, self.truth, self.scan):
            messages = stamps.wait(lambda m: len(m) > 50)
            times = [message.header.stamp.to_sec() for message in messages]
            gaps = [b - a for a, b in zip(times, times[1:])]
            self.assertTrue(all(abs(gap - 0.1) < 1e-6 for gap in gaps), gaps)
            self.assertEqual({message.header.stamp.nsecs % 10**8 for message in messages}, {0})
        frames = self.transforms.wait(lambda m: len(m) > 20)
        for child in ("base_footprint", "base_link", "base_laser_link"):
            times = [
                t.header.stamp.to_sec() for message in frames for t in message.transforms if t.child_frame_id == child
            ]
            self.assertTrue(all(abs(b - a - 0.1) < 1e-6 for a, b in zip(times, times[1:])), times)
        ticks = [message.clock.to_sec() for message in self.clock.wait(lambda m: len(m) > 20)]
        self.assertTrue(all(abs(b - a - 0.1) < 1e-6 for a, b in zip(ticks, ticks[1:])))

    def test_velocities_are_in_robot_frame_and_truth_in_world(self):
        """The robot looks along the world's y axis; without commands the watchdog stops it."""
        truth = self.drive_until(lambda m: m.twist.twist.linear.y > 0.1).twist.twist.linear
        self.assertAlmostEqual(truth.x, 0.0, places=3)
        self.drive_until(lambda _: self.odom.messages[-1].twist.twist.linear.x > 0.1)
        self.assertEqual(self.odom.messages[-1].twist.twist.linear.y, 0.0)
        self.odom.wait(lambda m: m and m[-1].twist.twist.linear.x == 0.0)

    def test_collision_is_reported_and_stops_robot(self):
        twist = Twist()
        twist.linear.x = 0.6

        self.place("", 15.0, 0.0, 0.0)
        before = len(self.collisions.messages)
        self.truth.wait(lambda _: len(self.collisions.messages) > before or self.command.publish(twist))
        self.assertIn("mailbot ran into a wall", self.collisions.messages[-1].data)

    def test_pause_and_step_control_time(self):
        self.assertTrue(self.pause(True).success)
        try:
            time = self.step(0).time
            answer = self.step(7)
            self.assertTrue(answer.success)
            self.assertAlmostEqual((answer.time - time).to_sec(), 0.7, places=6)
        finally:
            self.pause(False)
        self.assertIn("paused", self.step(1).message)

    def test_services_change_the_world_or_say_why_not(self):
        def ahead():
            return self.scan.wait(lambda m: len(m) > 1)[-1].ranges[135]

        self.assertGreater(ahead(), 2.0)
        self.assertTrue(self.door("office1", False).success)
        self.assertAlmostEqual(ahead(), 1.075 - 0.05, delta=0.1)
        self.assertIn("gate", self.door("gate", True).message)
        self.assertTrue(self.put("crate", 1.9, 0.8, 0.2, 0.0, 0.0, 0.0).success)
        self.assertAlmostEqual(ahead(), 0.55, delta=0.1)
        self.assertEqual([self.remove("crate").success for _ in range(2)], [True, False])
        self.assertTrue(self.place("mailbot", 5.0, 0.2, 1.0).success)
        pose = self.truth.wait(lambda m: len(m) > 1)[-1].pose.pose
        self.assertAlmostEqual(pose.position.x, 5.0)
        self.assertAlmostEqual(2.0 * math.atan2(pose.orientation.z, pose.orientation.w), 1.0)
        self.assertIn("wall", self.place("", 7.93, 3.0, 0.0).message)
        self.assertTrue(self.put("crate", *START, 0.2, 0.0, 0.0, 0.0).success)
        with self.assertRaisesRegex(rospy.ServiceException, "mailbot"):
            rospy.ServiceProxy("reset_positions", Empty)()
        self.assertTrue(self.remove("crate").success)
        self.assertTrue(self.door("office1", True).success)

    def test_speed_parameter_is_checked(self):
        speed = self.service("set_speed", SetSpeed)
        self.assertEqual([speed(value).success for value in (-1.0, math.nan, 20.0)], [False, False, True])

    def test_zzz_killed_simulator_restores_positions_at_time_0(self):
        self.assertTrue(self.place("", 3.5, 0.5, 1.0).success)
        self.assertTrue(self.door("corridor", False).success)
        self.assertTrue(self.put("bin", 5.0, 0.0, 0.2, 0.0, 0.0, 0.0).success)
        self.drive_until(lambda message: message.twist.twist.angular.z > 0.5, 0.0, 1.0)
        last = self.stop()
        stands = last.pose.pose
        self.assertGreater(stands.orientation.z, math.sin(0.51))
        wait_until(lambda: self.is_kept(stands), "all to be kept")
        kill("simulator")
        again = self.truth.wait(lambda m: m and m[-1].header.stamp < last.header.stamp)[-1]
        self.assertEqual(again.pose.pose, stands)
        self.assertTrue(self.remove("bin").success)
        rospy.ServiceProxy("reset_positions", Empty)()
        self.assertTrue(self.place("", 6.9, 0.0, 0.0).success)
        self.assertLess(self.scan.wait(lambda m: len(m) > 1)[-1].ranges[135], 1.1, "the door is closed")

    def stop(self):
        """Return where the robot stands after a last command, which turns it back a little: no command follows."""
        self.command.publish(Twist(angular=Vector3(z=-0.1)))

        def stands(messages):
            turned_back = any(message.twist.twist.angular.z < 0.0 for message in messages)
            return turned_back and messages[-1].twist.twist.angular.z == 0.0

        return self.truth.wait(stands)[-1]

    def is_kept(self, pose):
        kept = rospy.get_param("/simulator/kept", {"robots": {}})
        x, y, yaw = kept["robots"].get("mailbot", [0.0] * 6)[:3]
        return (x, y) == (pose.position.x, pose.position.y) and abs(math.sin(yaw / 2.0) - pose.orientation.z) < 1e-9
