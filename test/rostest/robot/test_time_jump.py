"""The first launch, and a robot whose goal is cancelled, whose parts end or are killed: requests are met.

Of the first launch numba's cache is empty; a goal that is sent at once succeeds, and the delay is explained.
"""

import os
import shutil
import unittest

import rosnode
import rospy
from actionlib_msgs.msg import GoalStatus, GoalStatusArray
from core_helpers import Client
from interface_helpers import PATIENCE, kill, send_request, wait_for_server, wait_to_hear
from navigation_helpers import ABORTED, PREEMPTED, SUCCEEDED, Driver, SteadyClient, pose_goal
from rosgraph_msgs.msg import Log
from rosoclingo.msg import InterfaceIO, PackageStates, PickupAction, PickupGoal
from rosoclingo.srv import SetSpeed

from rosoclingo.reasoning.keywords import CORE

COMPILING = 500.0  # limit in seconds of wall time: a minute of computing, on any busy machine


def set_speed(speed):
    """Set the speed of the simulator; one that starts again has the launch file's."""
    rospy.wait_for_service("simulator/set_speed", PATIENCE)
    rospy.ServiceProxy("simulator/set_speed", SetSpeed)(speed)


class FirstLaunch(unittest.TestCase):
    def test_goal_sent_at_once_succeeds(self):
        said = []
        log = rospy.Subscriber("/rosout", Log, lambda one: said.append((one.name, one.msg)), queue_size=None)
        self.addCleanup(log.unregister)
        status, result = Client().send("goal(office2,office1,4)").wait(COMPILING)
        text = "\n".join(": ".join(one) for one in said)
        self.assertEqual(status, GoalStatus.SUCCEEDED, f"{result}\n{text}")
        self.assertIn("/move_base: compiling navigation once", text)
        self.assertIn("/move_base_interface: move_base: waiting for the action server move_base to start", text)
        self.assertNotIn("server_lost", text)
        self.assertTrue(os.listdir(rospy.myargv()[2]), "nothing was kept")


class Preemption(unittest.TestCase):
    """With ~preempt the robot stops at once if its goal is cancelled while it drives; at normal speed."""

    def setUp(self):
        set_speed(1.0)
        self.addCleanup(set_speed, 3.0)

    def test_cancel_while_driving_stops_the_robot(self):
        office2 = rospy.get_param("/rosoclingo/labels")["office2"]
        commands = []

        def note(message):
            """Record the messages to interfaces, except those that announce the run."""
            if message.interface != CORE:
                commands.extend(message.facts)

        subscriber = rospy.Subscriber("out_rosoclingo", InterfaceIO, note)
        self.addCleanup(subscriber.unregister)
        wait_to_hear(subscriber)
        robot, client = Driver(), Client()
        goal = client.send("goal(office3,office2,1)")
        robot.wait(lambda: robot.speed[0] > 0.2)
        goal.cancel()
        status, result = goal.wait()
        self.assertEqual(status, PREEMPTED, result)
        begun, cancelled = commands
        self.assertTrue(begun.startswith("_action_lib(move_base,office2,"), begun)
        self.assertEqual(cancelled, begun.replace("_action_lib", "_cancel"))
        self.assertGreater(abs(robot.pose[0] - office2["x"]), 0.5, "it went all the way")
        robot.wait(lambda: robot.speed == (0.0, 0.0))
        self.assertGreater(abs(robot.pose[0] - office2["x"]), 0.5)


class TimeJump(unittest.TestCase):
    def test_time_goes_back_on_the_way(self):
        driver = Driver()
        driver.wait(lambda: rospy.get_time() > 15.0)  # so far back that the goals to come are stamped before the last
        driver.send(pose_goal(13.9, 0.0))
        driver.wait(lambda: driver.speed[0] > 0.3)
        driver.client.cancel_goal()
        self.assertEqual(driver.end()[0], PREEMPTED)
        driver.send(pose_goal(4.0, 0.0))
        driver.wait(lambda: driver.speed[0] > 0.3)
        set_speed(0.3)  # the simulator ends before the goal is reached, also on a busy machine
        cancelled = rospy.get_time()
        pickup = SteadyClient("pickup", PickupAction)
        wait_for_server(pickup.action_client)
        pickup.cancel_goals_at_and_before_time(rospy.Time.from_sec(cancelled + 1000.0))
        ended = pickup.send_goal_and_wait(PickupGoal(package="1"))
        self.assertIn(ended, (GoalStatus.RECALLED, PREEMPTED), "the cancel can overtake the goal")
        rosnode.kill_nodes(["/simulator"])
        driver.wait(lambda: rospy.get_time() < cancelled)
        self.assertEqual(driver.end(), (SUCCEEDED, "Goal reached."))
        self.assertLess(driver.distance(4.0, 0.0), 0.2)
        rospy.sleep(0.1)
        self.assertLess(rospy.get_time(), cancelled + 900.0, "the goals to come are stamped before the cancel")
        self.assertEqual(driver.drive(3.0, 0.0)[0], SUCCEEDED)
        self.assertEqual(driver.collisions, [])
        self.assertEqual(pickup.send_goal_and_wait(PickupGoal(package="1")), ABORTED, "package 1 is not here")
        for server in ("move_base", "pickup", "deliver"):
            now = rospy.get_time()
            while (
                rospy.wait_for_message(server + "/status", GoalStatusArray, timeout=PATIENCE).header.stamp.to_sec()
                <= now
            ):
                pass


class Killed(unittest.TestCase):
    """Each part of the robot and of the interface layer is killed while a request is under way."""

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(rospy.myargv()[2], ignore_errors=True)

    def drives(self):
        self.driver.wait(lambda: self.driver.speed[0] > 0.3)

    def place(self, package):
        message = rospy.wait_for_message("packages", PackageStates, timeout=PATIENCE)
        return next(one.location for one in message.packages if one.id == package)

    def test_request_survives_navigation_and_simulator(self):
        self.driver = Driver()
        with send_request("goal(office3,office2,1)") as request:
            self.drives()
            stops = self.driver.stops
            kill("move_base")
            self.driver.wait(lambda: self.driver.stops > stops)
            self.drives()
            kill("map_server", "fake_localization", "move_base")
            self.drives()
            before = rospy.get_time()
            kill("simulator")
            self.driver.wait(lambda: rospy.get_time() < before)
            self.drives()
            kill("simulator", "move_base", "move_base_interface", "office")
            self.assertEqual(request.wait()[0], 0)
        self.assertEqual(self.place("1"), "office2")
