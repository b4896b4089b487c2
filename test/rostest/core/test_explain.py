"""The core's service ~explain: why a goal was aborted, while the core continues."""

import json
import re
import subprocess
import threading
import unittest
from pathlib import Path

import rospy
import yaml
from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, ManualInterfaces
from interface_helpers import PATIENCE, kill
from rosoclingo.srv import Explain, ExplainResponse


class ExplainGoals(unittest.TestCase):
    def setUp(self):
        self.hands = ManualInterfaces()
        self.hands.at_once = True
        self.client = Client()
        rospy.wait_for_service("/rosoclingo/explain", PATIENCE)
        self.explain = rospy.ServiceProxy("/rosoclingo/explain", Explain)

    @staticmethod
    def asked(ask):
        """Return the answer of a function that asks; on a slow machine repeat the question after a time-out."""
        for _ in range(10):
            found = ask()
            if found.success or "found out in" not in found.message:
                break
        return found

    @staticmethod
    def ran(command):
        """Return the output of a command of the page."""
        return subprocess.check_output(["bash", "-c", command], text=True, timeout=PATIENCE)

    def test_aborted_goal_is_explained_while_others_are_served(self):
        unknown = self.explain("7")
        self.assertFalse(unknown.success)
        self.assertEqual(unknown.message, "no goal '7' was aborted for lack of a plan; aborted goals: none")

        self.hands.tell("_blocked(office2,office3,now)")
        goal = self.client.send("goal(office1,office4,7)")
        goal.ends_as(GoalStatus.ABORTED)
        page = (Path(__file__).resolve().parents[3] / "doc" / "why_no_plan.md").read_text()
        call, printed = re.findall(r"^    (rosservice call /rosoclingo/explain .*)$", page, re.MULTILINE)
        answers = []
        asking = threading.Thread(
            target=lambda: answers.append(self.asked(lambda: ExplainResponse(**yaml.safe_load(self.ran(call)))))
        )
        asking.start()
        self.client.send("goal(office1,office2,8)").ends_as(GoalStatus.SUCCEEDED)
        asking.join(PATIENCE)

        (found,) = answers
        self.assertTrue(found.success, found.message)
        self.assertIn("goal(office1,office4,7): No plan of at most 20 steps", found.message)
        self.assertIn("delivery/rules.lp", found.message)
        self.assertIn("delivery/faults.lp", found.message)
        self.assertIn("asserted: _blocked(office2,office3,", found.message)
        reason = json.loads(found.reason)
        self.assertEqual({one["rule"]["kind"] for one in reason["rules"][:1]}, {"volatile constraint"})
        self.assertIn("goal(office1,office4,7)", self.ran(printed))

        known = self.explain("8")
        self.assertFalse(known.success)
        self.assertIn("aborted goals: goal(office1,office4,7)", known.message)

        kill("/rosoclingo")
        rospy.wait_for_service("/rosoclingo/explain", PATIENCE)
        again = self.asked(lambda: self.explain(goal.handle.comm_state_machine.action_goal.goal_id.id))
        self.assertTrue(again.success, again.message)
        self.assertEqual(json.loads(again.reason)["stream_facts"], reason["stream_facts"])
