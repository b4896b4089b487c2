"""Commands of an operator: ~pause withholds actions, also after a kill, and ~stop ends all goals and actions."""

import shutil
import unittest

import rospy
from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, ManualInterfaces, Updates
from diagnostic_msgs.msg import DiagnosticStatus
from interface_helpers import PATIENCE, CommandProcess, kill, wait_for_diagnosis, wait_until
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

NODE = "/rosoclingo"


def warns_of_pause(status):
    return status.level == DiagnosticStatus.WARN and status.message.startswith("paused")


class Operator(unittest.TestCase):
    number = 100  # of the last goal; another test of this core has smaller numbers

    @classmethod
    def setUpClass(cls):
        cls.modes = []
        cls.mode = rospy.Subscriber("rosoclingo/mode", String, lambda message: cls.modes.append(message.data))
        cls.hands, cls.client, cls.updates = ManualInterfaces(), Client(), Updates()
        cls.pause, cls.stop = (
            rospy.ServiceProxy("rosoclingo/pause", SetBool),
            rospy.ServiceProxy("rosoclingo/stop", Trigger),
        )

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(rospy.myargv()[2], ignore_errors=True)

    def setUp(self):
        self.hands.connect()
        rospy.wait_for_service("rosoclingo/stop", PATIENCE)
        self.pause(False)
        self.wait_for_mode("running")

    def wait_for_mode(self, mode):
        wait_until(lambda: self.modes[-1:] == [mode], f"the mode {mode}")

    def walk(self):
        """Send a goal with an identifier of its own."""
        Operator.number += 1
        return self.client.send(f"do(walk,{self.number})")

    def actions_of(self, goal):
        """Return the actions that were sent for a goal, and their cancellations."""
        identifier = goal.text.rpartition(",")[2][:-1]
        return [one for one in self.hands.seen if f"(walk,{identifier}," in one]

    def test_paused_core_plans_and_continues_after_a_kill(self):
        first = self.walk()
        command = self.hands.take()
        self.assertTrue(self.pause(True).success)
        self.wait_for_mode("paused")
        second = self.walk()
        second.arrived()
        self.hands.succeed(command)
        self.updates.wait_for(f"_request(do(walk,{self.number})")
        wait_until(lambda: second.handle.get_goal_status() == GoalStatus.ACTIVE, "the goal of the pause to be accepted")
        wait_for_diagnosis("rosoclingo: core", warns_of_pause, "the pause on /diagnostics")
        wait_until(lambda: any("paused" in one.status for one in second.feedback), "the feedback to say so")
        kill(NODE)
        self.hands.connect()
        self.wait_for_mode("paused")
        third = self.walk()
        wait_until(third.has_arrived, "a goal to arrive at the resumed core")
        wait_until(lambda: third.handle.get_goal_status() == GoalStatus.ACTIVE, "it to be accepted")
        self.assertEqual([self.actions_of(one) for one in (second, third)], [[], []])
        rospy.wait_for_service("rosoclingo/pause", PATIENCE)
        self.assertTrue(self.pause(False).success)
        for _ in range(2):
            self.hands.succeed(self.hands.take())
        for goal in (first, second, third):
            goal.ends_as(GoalStatus.SUCCEEDED)

    def test_stopped_core_ends_all_goals_and_serves_new_ones(self):
        goals = [self.walk() for _ in range(3)]
        command = self.hands.take()
        with CommandProcess("watch") as account:
            account.lines_until("walks")
            self.assertIn("stopped", self.stop().message)
            account.lines_until("stopped: the next goal continues")
        for goal in goals:
            self.assertIn("an operator has stopped the core", goal.ends_as(GoalStatus.ABORTED))
        self.assertEqual(self.hands.take(), command.replace("_action_lib", "_cancel"))
        self.wait_for_mode("stopped")
        self.hands.fail(command, "preempted")
        wait_for_diagnosis("rosoclingo: core", lambda one: one.message == "stopped: idle", "an idle core")
        self.assertEqual(sum(one.startswith("_action_lib") for goal in goals for one in self.actions_of(goal)), 1)
        goal = self.walk()
        self.hands.succeed(self.hands.take())
        goal.ends_as(GoalStatus.SUCCEEDED)
        self.wait_for_mode("running")
