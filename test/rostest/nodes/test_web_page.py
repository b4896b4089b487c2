"""The live page with a real core: the goals in a browser, also after the core was killed and restarted."""

import math
import unittest
from contextlib import ExitStack

import browser
import rospy
from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, ManualInterfaces
from geometry_msgs.msg import TransformStamped
from interface_helpers import kill, refuses, wait_for_server, wait_until
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from rosoclingo.common.connections import is_delivered_to
from rosoclingo.nodes.pages.web_node import WebNode

TOPICS = [
    "/in_rosoclingo",
    "/out_rosoclingo",
    *(f"/rosoclingo/{name}" for name in ("goals", "task_plan", "updates")),
]
GOAL = "goal(office2,office3,1)"


class WebPage(unittest.TestCase):
    stack = ExitStack()

    @classmethod
    def setUpClass(cls):
        cls.hands = ManualInterfaces()
        cls.hands.at_once = True
        cls.client = Client()
        for topic in TOPICS:
            wait_until(lambda topic=topic: is_delivered_to("/web", topic), f"{topic} to come to the page's node")
        cls.address = rospy.wait_for_message("web/address", String).data
        path = browser.found()
        if path is None:
            raise unittest.SkipTest("there is no browser: install chromium")
        cls.page = cls.stack.enter_context(browser.Browser(path))
        cls.page.size(1280, 900)

    @classmethod
    def tearDownClass(cls):
        cls.stack.close()

    def setUp(self):
        self.page.open(self.address)
        self.connected()
        self.page.faults.clear()

    def connected(self):
        self.page.wait_for("document.getElementById('connection').textContent === 'Live'")

    def goals(self, states):
        self.page.wait_for(
            f"[...document.querySelectorAll('#goals .state')].map((one) => one.textContent).join() === '{states}'"
        )

    def test_goals_are_shown_also_after_a_kill(self):
        self.assertEqual(self.page.text("h1"), "The page's test")
        self.page.wait_for("document.querySelectorAll('.labelname').length === 4")
        self.client.send(GOAL).ends_as(GoalStatus.SUCCEEDED)
        self.goals("done")
        self.page.wait_for("document.querySelectorAll('.timeline .bar.done').length > 4")
        self.page.wait_for("document.querySelector('#log').textContent.includes('office2')")
        self.client.send("goal(office2,office9,1)").ends_as(GoalStatus.REJECTED)
        self.goals("done,rejected")
        self.assertNotEqual(self.page.texts("#goals td:last-child")[1], "")
        self.hands.at_once = False
        self.client.send("goal(office3,office4,1)").arrived()
        self.goals("done,rejected,under way")
        kill("/rosoclingo")
        self.goals("done,rejected,lost")
        self.connected()
        self.hands.at_once = True
        self.hands.connect()
        wait_for_server(self.client.raw)
        self.client.send("goal(office3,office4,2)").ends_as(GoalStatus.SUCCEEDED)
        self.goals("done,rejected,lost,done")
        self.assertEqual(self.page.faults, [])

    def test_scans_are_shown_as_long_as_they_are_wanted(self):
        scans = rospy.Publisher("odd/laser", LaserScan, queue_size=1)
        frames = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
        turned = TransformStamped(child_frame_id="odd_laser")
        turned.header.frame_id = "map"
        turned.transform.translation.x, turned.transform.rotation.w = 2.0, 1.0
        frames.publish([turned])
        scan = LaserScan(angle_min=0.0, angle_increment=math.pi / 2, range_min=0.1, range_max=10.0)
        scan.header.frame_id, scan.ranges = "odd_laser", [1.0, math.inf, 0.05, math.nan]
        self.page.run("document.getElementById('scans').click()")
        wait_until(scans.get_num_connections, "the page's node to subscribe")

        def shown():
            scans.publish(scan)
            return self.page.run("document.querySelectorAll('.map .scan').length")

        wait_until(shown, "the scan to be on the map")
        self.assertEqual(
            self.page.run("live.model.scans.map((one) => [one.topic, one.points])"), [["/odd/laser", [[3, 0]]]]
        )
        self.page.run("document.getElementById('scans').click()")
        self.assertEqual(self.page.run("document.querySelectorAll('.map .scan').length"), 0)
        wait_until(lambda: scans.get_num_connections() == 0, "the page's node to unsubscribe")
        self.assertEqual(self.page.faults, [])

    def test_unusable_settings_are_reported(self):
        port = int(self.address.rstrip("/").rpartition(":")[2])
        for name, value, reported in (
            ("port", port, "cannot be served on 127.0.0.1"),
            ("port", 99999, "port"),
            ("host", 7, "host"),
        ):
            refuses(WebNode, reported, **{name: value})
