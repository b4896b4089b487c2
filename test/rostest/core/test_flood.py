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

    def test_goals_are_served_during_a_flood_of_facts(self):
        wait_until(lambda: self.reports, "a report")
        before = self.problems()

        def taken():
            """Return how many facts of the floods the core has accepted or ignored."""
            return self.problems() - before + sum(one.count("_seen(") for one in self.updates)

        commands = [[sys.executable, str(Path(__file__).resolve()), "--flood", kind] for kind in FLOODS]
        with Process(*commands[0]) as one, Process(*commands[1]) as other:
            wait_until(lambda: taken() > 2000, "the flood")
            goal = self.client.send("do(walk,10)")
            self.hands.succeed(self.hands.take())
            goal.ends_as(GoalStatus.SUCCEEDED)
            goal = self.client.send("do(walk,11)")
            command = self.hands.take()
            goal.cancelled()
            self.hands.succeed(command)
            self.assertIn(goal.wait()[0], (GoalStatus.SUCCEEDED, GoalStatus.PREEMPTED))
            reports = len(self.reports)
            wait_until(lambda: len(self.reports) >= reports + 2, "reports during the flood")
            for process in (one, other):
                process.signal(signal.SIGKILL)
        self.assertIn("is ignored", self.reports[-1]["last error"])
        self.assertTrue(any("_seen(" in one for one in self.updates))


if __name__ == "__main__":
    if "--flood" in sys.argv:
        flood(sys.argv[sys.argv.index("--flood") + 1])
    else:
        init_node("flood_test")
        rostest.rosrun("rosoclingo", "flood", Flood, sys.argv)
