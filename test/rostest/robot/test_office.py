"""The office node: effects of its servers on the packages, with the robot here, there, and at no known place."""

import threading
import unittest

import rospy
import tf2_ros
from actionlib import ActionClient, GoalStatus
from actionlib.action_client import CommState
from documented_names import check_names
from interface_helpers import Process, base_at, executable, refuses, wait_for_server, wait_until
from rosoclingo.msg import (
    PackageStates,
    PickupAction,
    PickupGoal,
    PickupResult,
)
from rosoclingo.srv import PutPackage

from rosoclingo.robot.nodes.office import OfficeNode


class Robot:
    """Publishes the robot's pose until it is lost."""

    def __init__(self):
        self._broadcaster = tf2_ros.TransformBroadcaster()
        self.x = None
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        while not rospy.is_shutdown():
            if self.x is not None:
                transform = base_at(self.x, 0.0)
                transform.header.stamp = rospy.get_rostime()
                self._broadcaster.sendTransform(transform)
            rospy.sleep(0.02)


def places_in(message):
    """Return where each package is."""
    return {package.id: "carried" if package.carried else package.location for package in message.packages}


class Office(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = Robot()
        cls.places = {}
        rospy.Subscriber("packages", PackageStates, cls.note)
        cls.pickup = ActionClient("pickup", PickupAction)
        wait_for_server(cls.pickup)
        rospy.wait_for_service("office/put_package")
        cls.put = staticmethod(rospy.ServiceProxy("office/put_package", PutPackage))

    @classmethod
    def note(cls, message):
        cls.places = places_in(message)

    def setUp(self):
        for package, label in {"1": "office1", "2": "office1", "3": "office1", "4": "office1", "5": "office2"}.items():
            self.assertTrue(self.put(package, label).success)
        self.stand(0.1)

    def stand(self, x):
        """Report the robot at x, and wait until the office knows: a failed pickup names the place of the robot."""
        self.robot.x = x
        where = {True: "office1", False: "office2"}[x < 2.0] if abs(x - 2.5) > 2.0 else ""
        wait_until(lambda: self.pick("nothing")[1].location == where, "the pose to arrive")

    def end(self, handle):
        wait_until(lambda: handle.get_comm_state() == CommState.DONE, "the goal to end")
        return handle.get_terminal_state(), handle.get_result()

    def pick(self, package):
        return self.end(self.pickup.send_goal(PickupGoal(package=package)))

    def test_names_match_the_reference_page(self):
        check_names("office", "/office", {})

    def test_lost_robot_handles_nothing(self):
        self.robot.x = None
        wait_until(lambda: self.pick("1")[1].outcome == PickupResult.NOT_AT_LABEL, "the pose to be too old")

    def test_cancel_while_waiting_and_while_handling(self):
        parameters = ["_labels:={office1: [0, 0]}", "_packages:={office1: [1, 2, 3]}", "_duration:=10"]
        with Process(executable("office"), "__ns:=slow", *parameters):
            places = {}
            topic = rospy.Subscriber("slow/packages", PackageStates, lambda message: places.update(places_in(message)))
            client = ActionClient("slow/pickup", PickupAction)
            wait_for_server(client)
            handles = [client.send_goal(PickupGoal(package=str(package))) for package in range(1, 4)]
            wait_until(lambda: handles[0].get_comm_state() == CommState.ACTIVE, "the arm to begin")
            wait_until(lambda: handles[2].get_comm_state() == CommState.PENDING, "the last goal to be known")
            handles[0].cancel()
            handles[2].cancel()
            ends = [self.end(handle) for handle in handles]
            self.assertEqual(
                [status for status, _ in ends], [GoalStatus.PREEMPTED, GoalStatus.SUCCEEDED, GoalStatus.RECALLED]
            )
            self.assertEqual(
                [result.outcome for _, result in ends], [PickupResult.PREEMPTED, 0, PickupResult.PREEMPTED]
            )
            wait_until(lambda: places.get("2") == "carried", "package 2 to be carried")
            self.assertEqual([places[package] for package in "13"], ["office1", "office1"])
            topic.unregister()

    def test_packages_can_be_put_and_removed(self):
        self.assertEqual(self.put("8", "office2").message, "package 8 is at office2")
        wait_until(lambda: self.places.get("8") == "office2", "the package to lie in office2")
        self.assertEqual(self.put("8", "").message, "package 8 is removed")
        wait_until(lambda: "8" not in self.places, "the package to be gone")
        for package, label, fault in (
            ("8", "", "no package 8"),
            ("8", "cellar", "no label cellar"),
            ("", "office1", "identifier"),
        ):
            answer = self.put(package, label)
            self.assertFalse(answer.success)
            self.assertIn(fault, answer.message)

    def test_unusable_parameters_are_refused(self):
        for fault, parameters in (
            ("~labels: is missing: give a mapping of names to {x, y, yaw} in the launch file, or", {}),
            ("~labels/b: must be {x, y, yaw} or [x, y, yaw], not 1", {"labels": {"b": 1}}),
            ("~packages/a[0]: package 1: no label a", {"packages": {"a": [1]}}),
            ("~capacity: must be an integer of at least 1, not 0", {"capacity": 0}),
            ("~capacity: must be an integer of at least 1, not 'many'", {"capacity": "many"}),
            ("~appear: must be true or false, not 1", {"appear": 1}),
            ("~duration: must be a number of at least 0, not 'long'", {"duration": "long"}),
            ("~tolerance: must be a number of at least 0, not -1", {"tolerance": -1}),
            ("~base_frame: must be a text, not 3", {"base_frame": 3}),
        ):
            values = {"labels": {"b": [1, 2]}, **parameters} if parameters else {}
            refuses(OfficeNode, fault, **values)
