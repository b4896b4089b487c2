#!/usr/bin/env python3
"""Nodes that flood the core with facts: goals, cancels, returns and diagnostics continue."""

import itertools
import signal
import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray
from rosoclingo.msg import InterfaceIO
from std_msgs.msg import String

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client, ManualInterfaces
from interface_helpers import Process, init_node, wait_to_hear, wait_until

#: The messages of a flood, with a running number.
FLOODS = {"undeclared": "reading({})", "declared": "_seen({})", "garbage": "x{}((", "returns": "_return(walk,{},1)"}


def flood(kind):
    """Run as the node that floods the core."""
    rospy.init_node("flood", anonymous=True)
    publisher = rospy.Publisher("in_rosoclingo", InterfaceIO, queue_size=10)
    numbers = itertools.count()
    while not rospy.is_shutdown():
        publisher.publish(InterfaceIO("sensor", [FLOODS[kind].format(next(numbers)) for _ in range(500)]))


class Flood(unittest.TestCase):
    def setUp(self):
        self.hands, self.client = ManualInterfaces(), Client()
        self.hands.wait_for("/rosoclingo")
        self.reports, self.updates = [], []
        for topic, kind, note in (
            ("/diagnostics", DiagnosticArray, self.note),
            ("rosoclingo/updates", String, lambda message: self.updates.append(message.data)),
        ):
            subscriber = rospy.Subscriber(topic, kind, note)
            wait_to_hear(subscriber, nodes=["/rosoclingo"])
            self.addCleanup(subscriber.unregister)

    def note(self, message):
        """Record a report of the core, as a table."""
        found = [one for one in message.status if one.name == "rosoclingo: core"]
        self.reports += [{pair.key: pair.value for pair in one.values} for one in found]

    def problems(self):
        """Return the number of problems so far."""
        return int(self.reports[-1]["problems"]) if self.reports else 0

    def goes_on_during(self, kinds, number):
        wait_until(lambda: self.reports, "a report")
        before, updates = self.problems(), len(self.updates)

        def taken():
            """Return how many facts of the flood the core has accepted or ignored."""
            return self.problems() - before + sum(one.count("_seen(") for one in self.updates[updates:])

        commands = [[sys.executable, str(Path(__file__).resolve()), "--flood", kind] for kind in kinds]
        with Process(*commands[0]) as one, Process(*commands[1]) as other:
            wait_until(lambda: taken() > 2000, "the flood")
            goal = self.client.send(f"do(walk,{number})")
            self.hands.succeed(self.hands.take())
            goal.ends_as(GoalStatus.SUCCEEDED)
            goal = self.client.send(f"do(walk,{number + 1})")
            command = self.hands.take()
            goal.cancelled()
            self.hands.succeed(command)
            self.assertIn(goal.wait()[0], (GoalStatus.SUCCEEDED, GoalStatus.PREEMPTED))
            reports = len(self.reports)
            wait_until(lambda: len(self.reports) >= reports + 2, "reports during the flood")
            for process in (one, other):
                process.signal(signal.SIGKILL)
        self.assertIn("is ignored", self.reports[-1]["last error"])

    def test_goals_are_served_during_declared_and_undeclared_facts(self):
        self.goes_on_during(["declared", "undeclared"], 10)

    def test_goals_are_served_during_garbage_and_stray_returns(self):
        self.goes_on_during(["garbage", "returns"], 20)


if __name__ == "__main__":
    if "--flood" in sys.argv:
        flood(sys.argv[sys.argv.index("--flood") + 1])
    else:
        init_node("flood_test")
        rostest.rosrun("rosoclingo", "flood", Flood, sys.argv)
