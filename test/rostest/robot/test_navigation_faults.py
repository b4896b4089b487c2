"""Navigation to all labels, and in difficulty: doors, obstacles, a lost laser, a moved robot; move_base's services."""

import copy
import functools
import math
import pathlib
import shutil
import tempfile
import unittest

import numpy as np
import rospy
from documented_names import documented, offered
from geometry_msgs.msg import PoseStamped
from interface_helpers import PATIENCE, wait_to_hear, wait_until
from map_msgs.msg import OccupancyGridUpdate
from move_base_msgs.msg import MoveBaseActionResult
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from nav_msgs.srv import GetPlan, LoadMap
from navigation_helpers import ABORTED, PREEMPTED, SUCCEEDED, Driver, pose_goal
from PIL import Image
from rosoclingo.srv import PutObstacle, RemoveObstacle, SetDoor
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header
from std_srvs.srv import Empty

PAGE = pathlib.Path(__file__).resolve().parents[3] / "doc" / "simulator_and_navigation.md"


class Relay:
    """Passes a topic on as another one, while it is ``on``."""

    def __init__(self, topic, relayed, kind):
        self.on, self._passed = True, 0
        self._publisher = rospy.Publisher(relayed, kind, queue_size=10)
        self._subscriber = rospy.Subscriber(topic, kind, self._pass)

    def _pass(self, message):
        if self.on:
            self._passed += self._publisher.get_num_connections() > 0
            self._publisher.publish(message)

    def wait(self):
        """Wait until a subscriber has received a message: a node that starts without a laser reports its loss."""
        wait_until(lambda: self._passed > 1, f"somebody to listen to {self._publisher.name}")


class NavigationFaults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.relays = {
            "base_scan": Relay("base_scan", "relayed_scan", numpy_msg(LaserScan)),
            "base_pose_ground_truth": Relay("base_pose_ground_truth", "relayed_truth", Odometry),
        }
        for relay in cls.relays.values():
            relay.wait()
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

    def test_reaches_every_label(self):
        labels = rospy.get_param("/labels")
        for name in ("office4", "office2", "office3", "office1"):
            label = labels[name]
            before = self.driver.feedback
            status, text = self.driver.drive(label["x"], label["y"], label["yaw"])
            self.assertEqual((status, text), (SUCCEEDED, "Goal reached."), name)
            self.assertLess(self.driver.distance(label["x"], label["y"]), 0.2)
            self.assertGreater(self.driver.feedback, before)

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

    def test_goal_in_the_robots_own_frame_is_reached(self):
        x, y, _ = self.driver.pose
        self.assertEqual(self.driver.drive(0.5, 0.0, frame="base_link")[0], SUCCEEDED)
        self.assertLess(abs(self.driver.distance(x, y) - 0.5), 0.25)

    def test_unusable_goals_are_aborted_with_reason(self):
        for x, y, frame, words in (
            (7.93, 3.0, "map", "the goal is in an obstacle of the map"),
            (1.0, 0.0, "moon", "moon"),
        ):
            status, text = self.driver.drive(x, y, frame=frame)
            self.assertEqual(status, ABORTED)
            self.assertIn(words, text)

    def test_robot_takes_detour_when_door_closes_on_its_way(self):
        self.driver.send(pose_goal(9.9, 0.0))
        self.driver.wait(lambda: self.driver.pose[0] > 4.0)
        self.assertTrue(self.door("corridor", False).success)
        south = []
        self.driver.wait(lambda: south.append(self.driver.pose[1]) or min(south) < -1.3)
        self.assertEqual(self.driver.end()[0], SUCCEEDED)
        self.assertLess(self.driver.distance(9.9, 0.0), 0.2)

    def test_lost_laser_stops_robot_and_ends_goal(self):
        self.lose("base_scan", "laser is lost")

    def test_lost_localization_stops_robot_and_ends_goal(self):
        self.lose("base_pose_ground_truth", r"Localisation is lost: .*transform from map to odom")

    def lose(self, topic, words):
        """Drive, lose a topic on the way, see the robot stop and its goal end; drive again with it."""
        self.driver.send(pose_goal(13.9, 0.0))
        self.driver.wait(lambda: self.driver.speed[0] > 0.3)
        self.relays[topic].on = False
        try:
            self.driver.wait(lambda: self.driver.speed == (0.0, 0.0))
            self.assertLess(self.driver.pose[0], 13.0)
            status, text = self.driver.end()
        finally:
            self.relays[topic].on = True
        self.assertEqual(status, ABORTED)
        self.assertRegex(text, words)
        self.assertEqual(self.driver.drive(2.5, 0.0)[0], SUCCEEDED)

    def ask(self, x, y, frame="map"):
        start, goal = PoseStamped(), PoseStamped()
        start.header.frame_id, goal.header.frame_id = "map", frame
        start.pose.position.x, goal.pose.position.x, goal.pose.position.y = 1.9, x, y
        return self.plan(start, goal, 0.0).plan

    def test_make_plan_returns_a_path(self):
        plan = self.ask(9.9, 0.0)
        self.assertEqual(plan.header.frame_id, "map")
        first, last = plan.poses[0].pose.position, plan.poses[-1].pose.position
        self.assertAlmostEqual(first.x, 1.9, delta=0.05)
        self.assertAlmostEqual(last.x, 9.9, delta=0.05)
        self.assertEqual(self.ask(7.93, 3.0).poses, [])
        self.assertEqual(self.ask(1.0, 0.0, "moon").poses, [])

    def test_nodes_have_the_names_of_the_reference_page(self):
        page = PAGE.read_text()
        remapped = {
            "move_base": {"base_scan": ("relayed_scan", "")},
            "fake_localization": {"base_pose_ground_truth": ("relayed_truth", "")},
        }
        for node in ("move_base", "simulator", "map_server", "fake_localization"):
            names = documented(node, f"/{node}", remapped.get(node, {}))
            self.assertEqual(offered(f"/{node}"), names)
            actions = {"/move_base/goal", "/move_base/cancel"}
            for name in names.published.keys() - actions | names.services.keys():
                if not name.startswith("/move_base/") or name.count("/") > 2:
                    self.assertIn(name.rsplit("/", 1)[-1], page)

    def test_costmaps_are_published_with_their_changes(self):
        """The global one is in the map's frame, the local one around the robot in odometry's; both publish updates."""

        def costmap():
            return rospy.wait_for_message("/move_base/global_costmap/costmap", OccupancyGrid, timeout=PATIENCE)

        whole = costmap()
        self.assertEqual((whole.header.frame_id, whole.info.width, whole.info.height), ("map", 348, 208))
        around = []
        subscriber = rospy.Subscriber("/move_base/local_costmap/costmap", OccupancyGrid, around.append)
        # The first one can be older than the reset of the robot.
        self.driver.wait(lambda: around and abs(around[-1].info.origin.position.x - (1.9 - 3.0)) < 0.06)
        subscriber.unregister()
        local = around[-1]
        self.assertEqual((local.header.frame_id, local.info.width, local.info.height), ("odom", 120, 120))
        updates = []
        names = (f"/move_base/{one}_costmap/costmap_updates" for one in ("global", "local"))
        wait_to_hear(*(rospy.Subscriber(name, OccupancyGridUpdate, updates.append) for name in names))
        put = rospy.ServiceProxy("/simulator/put_obstacle", PutObstacle)
        self.assertTrue(put("bin", 3.5, 0.0, 0.2, 0.0, 0.0, 0.0).success)
        try:
            self.driver.wait(lambda: {"map", "odom"} <= {update.header.frame_id for update in updates})
            update = next(update for update in updates if update.header.frame_id == "map")
            self.assertEqual(len(update.data), update.width * update.height)
            self.assertLess(update.width * update.height, 348 * 208 // 4)
            occupied = whole.data.count(100)
            wait_until(lambda: costmap().data.count(100) > occupied, "the costmap to have the bin")
            self.relays["base_scan"].on = False  # so that only the service can clear it
            since = rospy.get_time()
            self.driver.wait(lambda: rospy.get_time() > since + 2.0)
            rospy.ServiceProxy("/move_base/clear_costmaps", Empty)()
            self.assertEqual(costmap().data, whole.data)
        finally:
            self.relays["base_scan"].on = True
            rospy.ServiceProxy("/simulator/remove_obstacle", RemoveObstacle)("bin")

    def test_new_map_on_the_way_blocks_all_paths(self):
        """The map, but not the world, has a wall across the building; the goal under way ends, and so does the next."""
        change = rospy.ServiceProxy("/change_map", LoadMap)
        office = PAGE.parents[1] / "worlds" / "office.yaml"
        with tempfile.TemporaryDirectory() as folder:
            with Image.open(str(office.with_name("office.pgm"))) as image:
                image.paste(0, (172, 0, 176, image.height))
                image.save(str(pathlib.Path(folder, "office.pgm")))
            shutil.copy(str(office), folder)
            self.driver.send(pose_goal(9.9, 0.0))
            self.driver.wait(lambda: self.driver.speed[0] > 0.3)
            self.assertEqual(change(f"{folder}/office.yaml").result, 0)
        try:
            ends = [self.driver.end(), self.driver.drive(9.9, 0.0)]
        finally:
            change(str(office))
        for status, text in ends:
            self.assertEqual(status, ABORTED)
            self.assertIn("no path leads to the goal on the map", text)
        self.driver.wait(lambda: self.driver.speed == (0.0, 0.0))
        self.assertLess(self.driver.pose[0], 7.5)
        self.driver.wait(lambda: self.ask(9.9, 0.0).poses)
        self.assertEqual(self.driver.drive(9.9, 0.0)[0], SUCCEEDED)

    def test_broken_messages_do_no_harm(self):
        scan = rospy.wait_for_message("base_scan", numpy_msg(LaserScan), timeout=PATIENCE)
        relay = rospy.Publisher("relayed_scan", numpy_msg(LaserScan), queue_size=100)
        odom = rospy.Publisher("odom", Odometry, queue_size=100)
        charts = rospy.Publisher("map", OccupancyGrid, queue_size=10)
        self.driver.wait(lambda: all(p.get_num_connections() for p in (relay, odom, charts)))
        for changes in (
            {"ranges": np.array([], dtype=np.float32)},
            {"ranges": np.array([math.nan, math.inf, -math.inf, -1.0, 0.0, 1e30] * 45, dtype=np.float32)},
            {"angle_min": math.nan},
            {"angle_increment": math.inf},
            {"range_max": 0.0},
            {"range_max": math.nan},
            {"range_min": math.nan},
            {"header": Header(frame_id="moon", stamp=scan.header.stamp)},
        ):
            broken = copy.deepcopy(scan)
            for key, value in changes.items():
                setattr(broken, key, value)
            relay.publish(broken)
        wheels = Odometry(header=scan.header)
        wheels.header.frame_id = "odom"
        wheels.twist.twist.linear.x = math.nan
        odom.publish(wheels)
        charts.publish(OccupancyGrid(data=[0] * 7))
        self.assertIn("not finite", self.driver.drive(math.nan, 0.0)[1])
        self.assertIn("invalid quaternion", self.driver.drive(3.0, 0.0, math.nan)[1])
        self.assertEqual(self.driver.drive(3.0, 0.0)[0], SUCCEEDED)

    def test_simple_goal_is_driven_and_shown(self):
        shown, results = {}, []
        simple = rospy.Publisher("move_base_simple/goal", PoseStamped, queue_size=1)
        links = [rospy.Subscriber("move_base/result", MoveBaseActionResult, results.append)]
        frames = {
            "GridPlanner/plan": "map",
            "RolloutFollower/global_plan": "odom",
            "RolloutFollower/local_plan": "odom",
            "current_goal": "map",
        }
        for name in frames:
            kind = PoseStamped if name == "current_goal" else Path
            links.append(rospy.Subscriber("/move_base/" + name, kind, functools.partial(shown.setdefault, name)))
        wait_to_hear(*links)
        wait_until(simple.get_num_connections, "move_base to listen")
        simple.publish(pose_goal(5.9, 0.0).target_pose)
        self.driver.wait(lambda: results and len(shown) == 4)
        self.assertEqual(results[0].status.status, SUCCEEDED)
        self.assertLess(self.driver.distance(5.9, 0.0), 0.2)
        self.assertEqual({name: message.header.frame_id for name, message in shown.items()}, frames)
        self.assertAlmostEqual(shown["GridPlanner/plan"].poses[-1].pose.position.x, 5.9, delta=0.05)
