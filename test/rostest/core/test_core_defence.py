#!/usr/bin/env python3
"""The core's self-defence: /diagnostics, nonsense, concurrent actions, cancels by time stamp."""

import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rosgraph_msgs.msg import Log
from rosoclingo.msg import InterfaceIO

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client, ManualInterfaces, Updates
from interface_helpers import init_node, wait_to_hear, wait_until

CORES = ("/rosoclingo", "/arms/rosoclingo")
ENDED = (GoalStatus.PREEMPTED, GoalStatus.RECALLED)


class Diagnostics:
    """The diagnostics of the cores, latest last."""

    def __init__(self):
        self.reports = []
        wait_to_hear(rospy.Subscriber("/diagnostics", DiagnosticArray, self._note), nodes=CORES)

    def _note(self, message):
        assert message.header.stamp.to_sec() > 0.0
        self.reports += message.status

    def wait_for(self, condition, what, name="rosoclingo: core"):
        """Return the next report that meets the condition, with its values as a dict."""
        start, found = len(self.reports), []

        def look():
            for one in self.reports[start:]:
                values = {pair.key: pair.value for pair in one.values}
                if one.name == name and condition(one, values):
                    found.append((one, values))
            return found

        wait_until(look, what)
        return found[0]


class CoreDefence(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        init_node("core_defence_test")
        cls.diagnostics = Diagnostics()
        cls.hands = ManualInterfaces()
        cls.hands.wait_for("/rosoclingo")
        cls.arms = ManualInterfaces("/arms/")
        cls.arms.wait_for("/arms/rosoclingo")
        cls.client = Client()
        cls.updates = Updates()

    def tearDown(self):
        self.hands.clear()
        self.arms.clear()

    def test_diagnostics_show_the_state(self):
        goal = self.client.send("do(walk,1)")
        command = self.hands.take()
        status, values = self.diagnostics.wait_for(lambda _, one: one["awaited actions"] == command, "the action")
        self.assertEqual(status.hardware_id, "rosoclingo")
        self.assertEqual(values["open goals"], "1")
        self.assertEqual(values["cycle"], command.rsplit(",", 1)[1][:-1])
        self.assertGreaterEqual(int(values["horizon"]), int(values["cycle"]))
        self.assertGreater(float(values["last solve time"]) + float(values["last ground time"]), 0.0)
        self.hands.succeed(command)
        goal.ends_as(GoalStatus.SUCCEEDED)
        self.diagnostics.wait_for(lambda _, one: one["open goals"] == "0", "the end")

    def test_diagnostics_are_repeated_without_a_change(self):
        for _ in range(3):
            self.diagnostics.wait_for(lambda *_: True, "a report")

    def test_nonsense_is_reported_once_and_counted(self):
        lines = []
        log = rospy.Subscriber("/rosout", Log, lambda one: lines.append(one.msg), queue_size=10000)
        wait_to_hear(log, nodes=["/rosoclingo"])
        _, values = self.diagnostics.wait_for(lambda *_: True, "a report")
        before = int(values["problems"])
        facts = [f"_unheard({number})" for number in range(300)]
        self.hands.tell(*facts, origin="chatterbox")
        status, values = self.diagnostics.wait_for(lambda _, one: int(one["problems"]) >= before + 300, "the count")
        self.assertEqual(status.level, DiagnosticStatus.WARN)
        self.assertIn("'_unheard(299)' from 'chatterbox' is ignored", values["last error"])
        self.assertIn("'_unheard(299)' from 'chatterbox' is ignored", status.message)
        self.hands.tell("garbage((", origin="another")
        wait_until(lambda: any("from 'another'" in line for line in lines), "the other line")
        self.assertEqual(len([line for line in lines if "chatterbox" in line]), 1)
        goal = self.client.send("do(walk,2)")
        self.hands.succeed(self.hands.take())
        goal.ends_as(GoalStatus.SUCCEEDED)

    def take_all(self, number):
        return sorted(self.arms.take() for _ in range(number))

    def test_actions_of_one_cycle_can_fail_alone(self):
        messages = []
        wait_to_hear(rospy.Subscriber("/arms/out_rosoclingo", InterfaceIO, messages.append))
        goal = Client("arms/rosoclingo").send("both(1)")
        left, right, head = self.take_all(3)
        cycle = int(head.rsplit(",", 1)[1][:-1])
        self.assertEqual([left, right], [f"_action_lib(arm,{side}(1),{cycle})" for side in ("left", "right")])
        self.assertEqual(head, f"_action_lib(head,1,{cycle})")
        self.arms.tell(f"_return(arm,failed(left(1)),{cycle})")
        self.arms.succeed(head)
        _, values = self.diagnostics.wait_for(
            lambda _, one: one["awaited actions"] == right, "the others", "arms/rosoclingo: core"
        )
        self.assertEqual(values["cycle"], str(cycle), "the cycle goes on until each has returned")
        self.arms.succeed(right)
        again = self.arms.take()
        self.assertEqual(again, f"_action_lib(arm,left(1),{cycle + 1})", "only the failed action is retried")
        self.arms.succeed(again)
        goal.ends_as(GoalStatus.SUCCEEDED)
        first = [sorted(one.facts) for one in messages[:2]]
        self.assertIn([left, right], first, "an interface receives its actions in one message")

    def test_cancel_by_time_stamp_ends_the_older_goals(self):
        blocking = self.client.send("do(walk,4)")
        command = self.hands.take()
        older = self.client.send("do(run,5)")
        older.arrived()
        stamp = rospy.Time.now()
        wait_until(lambda: rospy.Time.now() > stamp, "time to pass")
        younger = self.client.send("do(swim,6)")
        younger.arrived()
        self.client.raw.cancel_goals_at_and_before_time(stamp)
        self.assertEqual(older.wait()[0], GoalStatus.RECALLED)
        self.hands.succeed(command)
        self.hands.succeed(self.hands.take())
        younger.ends_as(GoalStatus.SUCCEEDED)
        self.assertIn(blocking.wait()[0], ENDED)

    def test_cancel_all_while_an_action_runs(self):
        goals = [self.client.send("do(walk,7)")]
        command = self.hands.take()
        goals += [self.client.send(f"do(run,{number})") for number in range(8, 11)]
        for goal in goals:
            goal.arrived()
        self.client.raw.cancel_all_goals()
        for goal in goals[1:]:
            goal.ends_as(GoalStatus.RECALLED)
        self.hands.succeed(command)
        self.assertIn(goals[0].wait()[0], ENDED)
        self.diagnostics.wait_for(lambda _, one: one["open goals"] == "0", "rest")


if __name__ == "__main__":
    rostest.rosrun("rosoclingo", "core_defence", CoreDefence, sys.argv)
