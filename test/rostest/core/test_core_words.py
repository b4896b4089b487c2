"""Texts of the program for clients, a control program, and a missing interface."""

import unittest

import rospy
from actionlib.msg import TestAction
from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, ManualInterfaces, Updates
from diagnostic_msgs.msg import DiagnosticStatus
from interface_helpers import (
    Process,
    Server,
    executable,
    heard_log,
    values_of,
    wait_for_diagnosis,
    wait_until,
)
from rosoclingo.msg import GoalStates

LACKING = "errands/rosoclingo: core"
MISSING = "no interface 'hold' for _action_lib(hold,1,1): the interfaces are run, walk"


class CoreWords(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.hands = ManualInterfaces()
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

    def expect(self, goal, text, state):
        """Wait until the goal's status, its feedback and the topic of all goals agree."""
        wait_until(lambda: goal.handle.get_goal_status_text() == text, f"the status to say '{text}'")
        wait_until(lambda: goal.feedback and goal.feedback[-1].status == state, f"the feedback to say '{state}'")
        wait_until(lambda: goal.entry(self.goals).reason == text, f"the topic to say '{text}'")
        self.assertEqual(goal.entry(self.goals).status, GoalStatus.ACTIVE)

    def test_control_program_is_executed(self):
        hands = ManualInterfaces("suitcase/rosoclingo")
        hands.at_once = True
        Client("suitcase/rosoclingo").send("run(open_it,1)").ends_as(GoalStatus.SUCCEEDED)
        latches = sorted(latch for fact in hands.seen for latch in ("left", "right") if f"flip({latch})" in fact)
        self.assertEqual(latches, ["left", "right"], hands.seen)

    def test_missing_interface_is_reported_until_it_appears(self):
        lines, server = heard_log("/errands/rosoclingo"), Server("errands/hold", TestAction)
        self.wait_for_interfaces("run, walk")
        goal = Client("errands/rosoclingo").send("do(hold,1)")
        status = wait_for_diagnosis(LACKING, lambda one: one.message == MISSING, "the interfaces that exist")
        self.assertEqual(status.level, DiagnosticStatus.WARN)
        wait_until(lambda: goal.feedback and goal.feedback[-1].status == f"waiting: {MISSING}", "the client's feedback")
        wait_until(lambda: any(MISSING in line for line in lines), "the log")
        with Process(
            executable("interface"),
            "__name:=hand",
            "__ns:=errands",
            "_interfaces:={hold: {type: actionlib/TestAction}}",
        ):
            handle = server.accept()
            self.wait_for_interfaces("hold, run, walk")
            awaits = "waits for _action_lib(hold,1,1)"
            wait_for_diagnosis(LACKING, lambda one: one.message == awaits, "the end of the warning")
            wait_until(lambda: goal.feedback[-1].status == "pending", "feedback without the warning")
            handle.set_succeeded()
            goal.ends_as(GoalStatus.SUCCEEDED)
        self.wait_for_interfaces("run, walk")
        self.assertEqual(len([line for line in lines if MISSING in line]), 1, "it is reported once")

    @staticmethod
    def wait_for_interfaces(names):
        wait_for_diagnosis(LACKING, lambda one: values_of(one)["interfaces"] == names, names)
