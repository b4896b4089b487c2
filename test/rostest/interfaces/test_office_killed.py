#!/usr/bin/env python3
"""The office is killed, alone or with an interface: a pickup happens once, and the core receives the truth."""

import sys
import unittest
import uuid
from pathlib import Path

import rospy
import rostest
import tf2_ros
from actionlib_msgs.msg import GoalStatus, GoalStatusArray
from rosoclingo.msg import PackageStates
from rosoclingo.srv import PutPackage

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from interface_helpers import CoreSide, base_at, init_node, kill, wait_until

OFFICE3 = (9.9, 0.0)


class OfficeKilled(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        init_node("core_side")
        cls.robot = tf2_ros.StaticTransformBroadcaster()
        cls.robot.sendTransform(base_at(*OFFICE3))
        cls.places, cls.sender = {}, ""
        rospy.Subscriber("packages", PackageStates, cls.note)
        cls.arm = set()
        for server in ("pickup", "deliver"):
            rospy.Subscriber(server + "/status", GoalStatusArray, cls.note_status)
        rospy.wait_for_service("office/put_package")

    @classmethod
    def note(cls, message):
        cls.places = {one.id: "carried" if one.carried else one.location for one in message.packages}

    @classmethod
    def note_status(cls, message):
        cls.arm |= {one.goal_id.id for one in message.status_list if one.status == GoalStatus.ACTIVE}

    def setUp(self):
        self.core = CoreSide(uuid.uuid4().hex)
        self.core.wait_for("pickup_interface", "deliver_interface")
        rospy.ServiceProxy("office/put_package", PutPackage)("1", "office3")
        self.wait_for_place("office3")

    def tearDown(self):
        self.assertTrue(self.core.silent(), "one message answers an action")
        self.core.die()

    def wait_for_place(self, place):
        wait_until(lambda: self.places.get("1") == place, f"package 1 to be at {place}")

    def begin(self, name, cycle):
        """Begin an action and wait until the arm moves."""
        before = set(self.arm)
        self.core.begin(name, f"_action_lib({name},1,{cycle})")
        wait_until(lambda: self.arm - before, "the arm to move")

    def kill(self, *nodes):
        self.places.clear()
        kill(*nodes)

    def run_action(self, name, cycle):
        self.assertEqual(self.core.run(name, f"_action_lib({name},1,{cycle})"), [f"_return({name},1,{cycle})"])

    def test_killed_office_keeps_packages_in_place(self):
        self.run_action("pickup", 1)
        self.kill("office")
        self.wait_for_place("carried")
        self.core.wait_for("deliver_interface")
        self.run_action("deliver", 2)

    def test_office_killed_during_pickup(self):
        self.begin("pickup", 1)
        self.kill("office")
        answer = self.core.receive()
        wait_until(lambda: "1" in self.places, "the office to say where the package is")
        done = self.places["1"] == "carried"
        self.assertEqual(answer, ["_return(pickup,1,1)" if done else "_return(pickup,server_lost,1)"])

    def test_office_and_interface_killed_during_pickup(self):
        self.begin("pickup", 1)
        self.kill("office", "pickup_interface")
        self.assertEqual(self.core.receive(), ["_return(pickup,1,1)"])  # executed before the kill, or repeated after it
        self.wait_for_place("carried")


if __name__ == "__main__":
    rostest.rosrun("rosoclingo", "office_killed", OfficeKilled, sys.argv)
