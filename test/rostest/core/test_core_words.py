#!/usr/bin/env python3
"""Texts of the program that clients receive about goals, goals that no rule of it sees, and a control program."""

import os
import subprocess
import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from rosoclingo.msg import GoalState, GoalStates

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client, ManualInterfaces, Updates
from interface_helpers import PATIENCE, init_node, wait_until

ACTIVE = GoalStatus.ACTIVE


class CoreWords(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        init_node("core_words_test")
        cls.hands = ManualInterfaces()
        cls.hands.wait_for("/rosoclingo")
        cls.goals = GoalStates()
        cls.subscriber = rospy.Subscriber(
            "rosoclingo/goals", GoalStates, lambda message: setattr(cls, "goals", message)
        )
        updates = Updates()
        cls.hands.tell("_lift(3,now)", origin="lift")  # without it the program rejects goals
        updates.wait_for("_lift(3,")

    def test_text_of_an_accepted_goal_reaches_its_client(self):
        goal = Client().send("ride(1)")
        self.hands.tell("_lift(3,now)", origin="lift")
        self.expect(goal, "ride(1) is accepted: waits for the lift at 3", "active: waits for the lift at 3")
        self.hands.tell("_lift(2,now)", origin="lift")
        self.expect(goal, "ride(1) is accepted: waits for the lift at 2", "active: waits for the lift at 2")
        self.hands.tell("_lift(0,now)", origin="lift")
        command = self.hands.take()
        self.expect(goal, "ride(1) is accepted", "active")
        self.hands.succeed(command)
        self.assertEqual(goal.ends_as(GoalStatus.SUCCEEDED), "ride(1) is met")

    def test_last_word_of_a_sensor_counts(self):
        first = Client().send("ride(2)")
        self.hands.tell("_lift(0,now)", origin="lift")
        command = self.hands.take()
        for floor in (2, 7, 4):  # while the package is on the robot
            self.hands.tell(f"_lift({floor},now)", origin="lift")
        second = Client().send("ride(3)")
        second.arrived()
        self.hands.succeed(command)
        first.ends_as(GoalStatus.SUCCEEDED)
        self.expect(second, "ride(3) is accepted: waits for the lift at 4", "active: waits for the lift at 4")
        second.cancel()
        second.ends_as(GoalStatus.PREEMPTED)

    def expect(self, goal, text, state):
        """Wait until the goal's status, its feedback and the topic of all goals agree."""
        key = goal.handle.comm_state_machine.action_goal.goal_id

        def entry():
            return next((one for one in self.goals.goals if one.id == key), GoalState())

        wait_until(lambda: goal.handle.get_goal_status_text() == text, f"the status to say '{text}'")
        wait_until(lambda: goal.feedback and goal.feedback[-1].status == state, f"the feedback to say '{state}'")
        wait_until(lambda: (entry().status, entry().reason) == (ACTIVE, text), f"the topic to say '{text}'")

    def test_request_fails_for_a_goal_that_no_rule_sees(self):
        command = ["rosrun", "rosoclingo", "request", "gaol(office3,office2,1)", "--wait", "40"]
        done = subprocess.run(
            command,
            env={**os.environ, "ROS_NAMESPACE": "/paper"},
            stdout=subprocess.PIPE,
            text=True,
            timeout=PATIENCE,
        )
        self.assertEqual(done.returncode, 3, done.stdout)
        self.assertIn("did you mean goal(office3,office2,1)?", done.stdout)

    def test_control_program_is_executed(self):
        hands = ManualInterfaces("suitcase/")
        hands.at_once = True
        hands.wait_for("/suitcase/rosoclingo")
        Client("suitcase/rosoclingo").send("run(open_it,1)").ends_as(GoalStatus.SUCCEEDED)
        latches = sorted(latch for fact in hands.seen for latch in ("left", "right") if f"flip({latch})" in fact)
        self.assertEqual(latches, ["left", "right"], hands.seen)


if __name__ == "__main__":
    rostest.rosrun("rosoclingo", "core_words", CoreWords)
