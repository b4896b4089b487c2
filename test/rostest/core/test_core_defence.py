"""The core's self-defence: /diagnostics, nonsense, concurrent actions, cancels by time stamp, floods of facts."""

import signal
import unittest
from pathlib import Path

import rospy
from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, ManualInterfaces, Updates
from diagnostic_msgs.msg import DiagnosticStatus
from interface_helpers import Process, heard_log, values_of, wait_for_diagnosis, wait_to_hear, wait_until
from rosoclingo.msg import InterfaceIO

CORE = "rosoclingo: core"
FLOOD = str(Path(__file__).with_name("flood.py"))
ENDED = (GoalStatus.PREEMPTED, GoalStatus.RECALLED)


class CoreDefence(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.hands = ManualInterfaces()
        cls.arms = ManualInterfaces("arms/rosoclingo")
        cls.client = Client()
        cls.updates = Updates()

    def tearDown(self):
        self.hands.clear()
        self.arms.clear()

    @staticmethod
    def problems():
        """Return the number of problems so far."""
        return int(values_of(wait_for_diagnosis(CORE, lambda _: True, "a report"))["problems"])

    def test_diagnostics_show_the_state(self):
        goal = self.client.send("do(walk,1)")
        command = self.hands.take()
        status = wait_for_diagnosis(CORE, lambda one: values_of(one)["awaited actions"] == command, "the action")
        values = values_of(status)
        self.assertEqual(status.hardware_id, "rosoclingo")
        self.assertEqual(values["open goals"], "1")
        self.assertEqual(values["cycle"], command.rsplit(",", 1)[1][:-1])
        self.assertGreaterEqual(int(values["horizon"]), int(values["cycle"]))
        self.assertGreater(float(values["last solve time"]) + float(values["last ground time"]), 0.0)
        self.hands.succeed(command)
        goal.ends_as(GoalStatus.SUCCEEDED)
        wait_for_diagnosis(CORE, lambda one: values_of(one)["open goals"] == "0", "the end")

    def test_nonsense_is_reported_once_and_counted(self):
        lines = heard_log("/rosoclingo")
        before = self.problems()
        facts = [f"_unheard({number})" for number in range(300)]
        self.hands.tell(*facts, origin="chatterbox")
        status = wait_for_diagnosis(CORE, lambda one: int(values_of(one)["problems"]) >= before + 300, "the count")
        self.assertEqual(status.level, DiagnosticStatus.WARN)
        self.assertIn("'_unheard(299)' from 'chatterbox' is ignored", values_of(status)["last error"])
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
        status = wait_for_diagnosis(
            "arms/rosoclingo: core", lambda one: values_of(one)["awaited actions"] == right, "the others"
        )
        self.assertEqual(values_of(status)["cycle"], str(cycle), "the cycle goes on until each has returned")
        self.arms.succeed(right)
        again = self.arms.take()
        self.assertEqual(again, f"_action_lib(arm,left(1),{cycle + 1})", "only the failed action is retried")
        self.arms.succeed(again)
        goal.ends_as(GoalStatus.SUCCEEDED)
        sent = [sorted(one.facts) for one in messages]
        self.assertIn([left, right], sent, "an interface receives its actions in one message")

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

    def test_zzz_goals_are_served_during_a_flood_of_facts(self):
        """It comes last: the core still works on the facts when it is over."""
        before, updates = self.problems(), len(self.updates.texts)

        def taken(status):
            """Return whether the core has accepted or ignored many facts of the floods."""
            seen = sum(text.count("_seen(") for text in self.updates.texts[updates:])
            return seen and int(values_of(status)["problems"]) - before + seen > 2000

        with Process(FLOOD, "sensor") as one, Process(FLOOD, "stray") as other:
            wait_for_diagnosis(CORE, taken, "the flood")
            goal = self.client.send("do(walk,10)")
            self.hands.succeed(self.hands.take())
            goal.ends_as(GoalStatus.SUCCEEDED)
            goal = self.client.send("do(walk,11)")
            command = self.hands.take()
            goal.cancelled()
            self.hands.succeed(command)
            self.assertIn(goal.wait()[0], (GoalStatus.SUCCEEDED, GoalStatus.PREEMPTED))
            wait_for_diagnosis(
                CORE, lambda one: "is ignored" in values_of(one)["last error"], "a report during the flood"
            )
            for process in (one, other):
                process.signal(signal.SIGKILL)
