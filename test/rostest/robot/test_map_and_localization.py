"""The interfaces of map_server and fake_localization, and refusals of wrong parameters by the simulation's nodes."""

import contextlib
import math
import queue
import tempfile
import threading
import unittest
from pathlib import Path

import rospy
from geometry_msgs.msg import PoseArray, PoseWithCovarianceStamped, TransformStamped, Twist
from interface_helpers import PATIENCE, Process, executable, wait_to_hear
from nav_msgs.msg import MapMetaData, OccupancyGrid, Odometry
from nav_msgs.srv import GetMap, LoadMap, LoadMapResponse
from rosoclingo.srv import SetRobotPose, StepSimulation
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

ROOT = Path(__file__).resolve().parents[3]
OFFICE = str(ROOT / "worlds" / "office.yaml")
SMALL = "{image: small.pgm, resolution: 0.5, origin: [1, 2, 0], negate: 0, occupied_thresh: 0.65, free_thresh: 0.19}"


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.wait_for_service("change_map", timeout=PATIENCE)
        cls.get, cls.change = rospy.ServiceProxy("static_map", GetMap), rospy.ServiceProxy("change_map", LoadMap)

    def setUp(self):
        self.assertEqual(self.change(OFFICE).result, LoadMapResponse.RESULT_SUCCESS)

    def test_topics_and_service_agree(self):
        served = self.get().map
        shown = rospy.wait_for_message("map", OccupancyGrid, timeout=PATIENCE)
        metadata = rospy.wait_for_message("map_metadata", MapMetaData, timeout=PATIENCE)
        self.assertEqual(served.header.frame_id, "map")
        self.assertEqual((served.info.width, served.info.height), (348, 208))
        self.assertEqual((served.info.origin.position.x, served.info.origin.position.y), (-0.7, -5.2))
        self.assertEqual(served.info.origin.orientation.w, 1.0)
        self.assertEqual(served.data, shown.data)
        self.assertEqual(served.info, metadata)
        self.assertEqual(set(served.data), {-1, 0, 100})

    def test_another_map_can_be_loaded(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "small.yaml").write_text(SMALL)
            Path(folder, "small.pgm").write_bytes(b"P5 3 2 255 " + bytes([0, 254, 205, 254, 254, 254]))
            answer = self.change(str(Path(folder, "small.yaml")))
            self.assertEqual(answer.result, LoadMapResponse.RESULT_SUCCESS)
            self.assertEqual(list(answer.map.data), [0, 0, 0, 100, 0, -1])
            shown = rospy.wait_for_message("map", OccupancyGrid, timeout=PATIENCE)
            self.assertEqual((shown.info.width, shown.info.height, shown.info.resolution), (3, 2, 0.5))
            self.assertEqual(self.change("package://rosoclingo/worlds/office.yaml").map.info.width, 348)
            self.assertEqual(self.change(f"file://{folder}/small.yaml").map.info.width, 3)

    def test_broken_map_leaves_the_old_one(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "broken.yaml").write_text("image: [")
            Path(folder, "small.yaml").write_text(SMALL)
            Path(folder, "small.pgm").write_text("no image")
            for url, result in (
                (f"{folder}/nowhere.yaml", LoadMapResponse.RESULT_MAP_DOES_NOT_EXIST),
                (f"{folder}/broken.yaml", LoadMapResponse.RESULT_INVALID_MAP_METADATA),
                (f"{folder}/small.yaml", LoadMapResponse.RESULT_INVALID_MAP_DATA),
                ("package://no_such_package/map.yaml", LoadMapResponse.RESULT_INVALID_MAP_METADATA),
                ("https://example.org/map.yaml", LoadMapResponse.RESULT_INVALID_MAP_METADATA),
            ):
                self.assertEqual(self.change(url).result, result, url)
        self.assertEqual(self.get().map.info.width, 348)


class Localization(unittest.TestCase):
    """The map frame is the world, rotated by -90 degrees and moved by -1 m along x, as in fake_localization.
    Odometry has the robot turned by a quarter at (1, 0).
    """

    @classmethod
    def setUpClass(cls):
        cls.changed, cls.last = threading.Condition(), {}
        for name, kind in (("amcl_pose", PoseWithCovarianceStamped), ("particlecloud", PoseArray)):
            rospy.Subscriber(name, kind, cls.keep, name)
        rospy.Subscriber("/tf", TFMessage, cls.keep_transform)
        cls.truth = rospy.Publisher("base_pose_ground_truth", Odometry, queue_size=10)
        cls.tf = rospy.Publisher("/tf", TFMessage, queue_size=10)
        cls.initial = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=10)

    @classmethod
    def keep(cls, message, name):
        with cls.changed:
            cls.last[name] = message
            cls.changed.notify_all()

    @classmethod
    def keep_transform(cls, message):
        for transform in message.transforms:
            cls.keep(transform, transform.child_frame_id)

    def until(self, condition, x=4.0, y=2.0):
        """Publish a true position of the robot until a condition holds."""
        truth, odometry = Odometry(), TransformStamped()
        truth.pose.pose.position.x, truth.pose.pose.position.y, truth.pose.pose.orientation.w = x, y, 1.0
        odometry.header.frame_id, odometry.child_frame_id = "wheels", "body"
        odometry.transform.translation.x = 1.0
        odometry.transform.rotation.z = odometry.transform.rotation.w = math.sqrt(0.5)

        def look():
            truth.header.stamp = odometry.header.stamp = rospy.Time.now()
            self.tf.publish(TFMessage([odometry]))
            self.truth.publish(truth)
            return condition(self.last)

        with self.changed:
            end = rospy.get_time() + 60.0
            while not look():
                self.assertLess(rospy.get_time(), end, "the condition never held")
                self.changed.wait(0.05)

    def at(self, x, y):
        """Return whether the robot is at a place in the map."""
        position = self.last["amcl_pose"].pose.pose.position if "amcl_pose" in self.last else None
        return position is not None and math.hypot(position.x - x, position.y - y) < 1e-6

    def wheels_at(self, x, y):
        """Return whether odometry's frame is at a place in the map."""
        place = self.last["wheels"].transform.translation
        return math.hypot(place.x - x, place.y - y) < 1e-6

    def test_pose_cloud_and_transform_agree(self):
        names = {"amcl_pose", "particlecloud", "wheels"}
        # The robot is at (1, -4) with yaw -90 degrees in the map, and at (1, 0) with yaw 90 degrees by odometry.
        self.until(lambda last: names <= set(last) and self.at(1.0, -4.0) and self.wheels_at(2.0, -4.0))
        pose, cloud, transform = (self.last[name] for name in ("amcl_pose", "particlecloud", "wheels"))
        self.assertEqual([m.header.frame_id for m in (pose, cloud, transform)], ["floor"] * 3)
        self.assertAlmostEqual(2.0 * math.asin(pose.pose.pose.orientation.z), -math.pi / 2)
        self.assertEqual(len(cloud.poses), 1)
        self.assertAlmostEqual(abs(transform.transform.rotation.z), 1.0)
        self.assertGreater((transform.header.stamp - pose.header.stamp).to_sec(), 0.1)

    def test_zzz_initial_pose_moves_the_map(self):
        self.until(lambda last: self.initial.get_num_connections() and "amcl_pose" in last)
        for frame, x, w in (("floor", 99.0, 0.0), ("floor", math.nan, 1.0), ("moon", 99.0, 1.0), ("floor", 7.0, 1.0)):
            pose = PoseWithCovarianceStamped()
            pose.header.frame_id = frame
            pose.pose.pose.position.x, pose.pose.pose.orientation.w = x, w
            self.initial.publish(pose)
        self.until(lambda last: self.at(7.0, 0.0))
        self.until(lambda last: self.at(8.0, 0.0), x=5.0)
        pose.header.frame_id = "body"
        self.initial.publish(pose)
        self.until(lambda last: self.at(15.0, 0.0), x=5.0)

    def test_invalid_truth_is_ignored(self):
        self.until(lambda last: "amcl_pose" in last)
        before = self.last["amcl_pose"].pose.pose.position
        broken = Odometry()
        broken.pose.pose.position.x, broken.pose.pose.orientation.w = math.nan, 1.0
        broken.header.stamp = rospy.Time.now()
        self.truth.publish(broken)
        self.until(lambda last: self.at(before.x + 0.0, before.y - 1.0), x=5.0)


class WrongParameters(unittest.TestCase):
    def test_nodes_name_wrong_parameter_and_end(self):
        """All start at the same time, since starting takes most of the time."""
        wrong = {
            "map_server": (["/no/such/map.yaml"], "map /no/such/map.yaml: cannot be read"),
            "simulator": (["_world:=/no/such/world.yaml"], "world /no/such/world.yaml: cannot be read"),
            "move_base": (["_planner_patience:=long"], "~planner_patience: must be a number of at least 0, not 'long'"),
            "fake_localization": (["_delta_x:=far"], "~delta_x: must be a finite number, not 'far'"),
        }
        with contextlib.ExitStack() as stack:
            processes = {
                node: stack.enter_context(Process(executable(node), f"__name:=wrong_{node}", *arguments))
                for node, (arguments, _) in wrong.items()
            }
            for node, process in processes.items():
                process.refuses(wrong[node][1])


class SimulatorParameters(unittest.TestCase):
    """A simulator with every parameter other than its default; it stands still except for the requested steps."""

    def write(self, folder):
        """Make a world with a map of 2 m x 2 m, and another map of 10 m x 10 m."""
        for name, cells in (("small", 20), ("large", 100)):
            Path(folder, f"{name}.pgm").write_bytes(b"P5 %d %d 255 " % (cells, cells) + bytes([254]) * cells**2)
            text = SMALL.replace("small", name).replace("0.5, origin: [1, 2, 0]", "0.1, origin: [0, 0, 0]")
            Path(folder, f"{name}.yaml").write_text(text)
        lasers = (
            "[{beams: 9, range: 5, pose: [0, 0]}, {beams: 5, range: 3, angle: 90, pose: [-0.1, 0, 3.14159], rate: 2}]"
        )
        robots = f"[{{name: anna, pose: [1, 1, 0], lasers: {lasers}}}]"
        Path(folder, "world.yaml").write_text(f"{{map: small.yaml, robots: {robots}}}")

    def test_parameters_each_have_their_effect(self):
        with tempfile.TemporaryDirectory() as folder:
            self.write(folder)
            values = ("_paused:=true", "_use_model_names:=true", "_base_watchdog_timeout:=1.0", "_speed:=0")
            files = (f"_world:={folder}/world.yaml", f"_map:={folder}/large.yaml")
            with Process(executable("simulator"), "__name:=other", *values, *files):
                rospy.wait_for_service("other/step", timeout=PATIENCE)
                self.check()
                self.check_lasers()

    def check(self):
        step, place = (
            rospy.ServiceProxy("other/step", StepSimulation),
            rospy.ServiceProxy("other/set_pose", SetRobotPose),
        )
        self.assertEqual(step(0).time, step(0).time)
        self.assertTrue(place("anna", 8.0, 8.0, math.pi).success, "the large map is not the one")
        speeds = queue.Queue()
        odometry = rospy.Subscriber("anna/odom", Odometry, lambda odom: speeds.put(odom.twist.twist.linear.x))
        wait_to_hear(odometry, nodes=["other"])
        command, twist = rospy.Publisher("anna/cmd_vel", Twist, queue_size=1), Twist()
        twist.linear.x = 0.5

        def speed_after_a_step():
            step(1)
            return speeds.get(timeout=PATIENCE)

        moving = 0
        while speed_after_a_step() < 0.5:
            command.publish(twist)
        while speed_after_a_step() > 0.0:
            moving += 1
        # It drives for 1 s and brakes for two steps; by the default it would be two and two.
        self.assertTrue(8 <= moving <= 20, moving)

    def check_lasers(self):
        """Check that each has its own topic and frame, numbered as by stage_ros."""
        step = rospy.ServiceProxy("other/step", StepSimulation)
        scans, frames = [queue.Queue(), queue.Queue()], queue.Queue()
        for i in (0, 1):
            rospy.Subscriber(f"anna/base_scan_{i}", LaserScan, scans[i].put)
        rospy.Subscriber("/tf", TFMessage, frames.put)
        while scans[0].empty() or scans[1].empty() or frames.empty():
            step(5)
        front, back = scans[0].get(), scans[1].get()
        self.assertEqual([scan.header.frame_id[-1] for scan in (front, back)], ["0", "1"])
        self.assertEqual((len(front.ranges), len(back.ranges)), (9, 5))
        self.assertEqual((front.range_max, back.range_max, back.range_min), (5.0, 3.0, 0.0))
        self.assertAlmostEqual(back.angle_min + 4 * back.angle_increment, back.angle_max, places=5)
        sent = {t.child_frame_id: t for t in frames.get().transforms}
        self.assertEqual(sent["anna/base_laser_link_1"].header.frame_id, "anna/base_link")
        self.assertAlmostEqual(sent["anna/base_laser_link_1"].transform.translation.x, -0.1)
