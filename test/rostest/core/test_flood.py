#!/usr/bin/env python3
"""Nodes that flood the core with facts: goals, cancels and diagnostics continue."""

import itertools
import signal
import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from rosoclingo.msg import InterfaceIO

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client, ManualInterfaces, Updates
from interface_helpers import Process, init_node, values_of, wait_for_diagnosis

CORE = "rosoclingo: core"

#: The facts of two flooding nodes, with a running number. A return of a cycle that runs would fail its action.
FLOODS = {"sensor": ("_seen({})", "reading({})"), "stray": ("x{}((", "_return(walk,{},1000000)")}


def flood(kind):
    """Run as the node that floods the core: without a queue, it sends as fast as the core reads."""
    rospy.init_node("flood", anonymous=True)
    publisher = rospy.Publisher("in_rosoclingo", InterfaceIO, queue_size=None)
    numbers = itertools.count()
    for fact in itertools.cycle(FLOODS[kind]):
        if rospy.is_shutdown():
            break
        publisher.publish(InterfaceIO(kind, [fact.format(next(numbers)) for _ in range(500)]))


class Flood(unittest.TestCase):
    def setUp(self):
        self.hands, self.client, self.updates = ManualInterfaces(), Client(), Updates()
        self.hands.wait_for("/rosoclingo")

    def test_goals_are_served_during_a_flood_of_facts(self):
        report, updates = wait_for_diagnosis(CORE, lambda _: True, "a report"), len(self.updates.texts)
        before = int(values_of(report)["problems"])

        def taken(status):
            """Return whether the core has accepted or ignored many facts of the floods."""
            seen = sum(text.count("_seen(") for text in self.updates.texts[updates:])
            return seen and int(values_of(status)["problems"]) - before + seen > 2000

        commands = [[sys.executable, str(Path(__file__).resolve()), "--flood", kind] for kind in FLOODS]
        with Process(*commands[0]) as one, Process(*commands[1]) as other:
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


if __name__ == "__main__":
    if "--flood" in sys.argv:
        flood(sys.argv[sys.argv.index("--flood") + 1])
    else:
        init_node("flood_test")
        rostest.rosrun("rosoclingo", "flood", Flood, sys.argv)
