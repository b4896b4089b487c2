"""Nodes that flood the core with facts: goals, cancels and diagnostics continue."""

import signal
import unittest
from pathlib import Path

from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, ManualInterfaces, Updates
from interface_helpers import Process, values_of, wait_for_diagnosis

CORE = "rosoclingo: core"

FLOOD = str(Path(__file__).with_name("flood.py"))


class Flood(unittest.TestCase):
    def setUp(self):
        self.hands, self.client, self.updates = ManualInterfaces(), Client(), Updates()

    def test_goals_are_served_during_a_flood_of_facts(self):
        report, updates = wait_for_diagnosis(CORE, lambda _: True, "a report"), len(self.updates.texts)
        before = int(values_of(report)["problems"])

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
