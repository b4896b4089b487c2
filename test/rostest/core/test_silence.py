#!/usr/bin/env python3
"""Missing parts are reported within seconds: interfaces, on diagnostics and once in the log."""

import importlib.util
import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib.msg import TestAction
from actionlib_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rosgraph_msgs.msg import Log

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client
from interface_helpers import Process, Server, executable, init_node, wait_to_hear, wait_until

DATA = Path(__file__).resolve().parents[2] / "data"
NEEDS_TF2 = unittest.skipUnless(importlib.util.find_spec("tf2_ros"), "tf2_ros is not there for this Python")
MISSING = "no interface 'hold' for _action_lib(hold,1,1): the interfaces are run, walk"


class Silence(unittest.TestCase):
    def setUp(self):
        self.report, self.lines = DiagnosticStatus(), []
        subscribers = (
            rospy.Subscriber("/diagnostics", DiagnosticArray, self._note),
            rospy.Subscriber("/rosout", Log, lambda one: self.lines.append(one.msg), queue_size=1000),
        )
        wait_to_hear(*subscribers, nodes=["/rosoclingo"])

    def _note(self, message):
        self.report = next((one for one in message.status if one.name == "rosoclingo: core"), self.report)

    def interfaces(self):
        return {pair.key: pair.value for pair in self.report.values}.get("interfaces")

    def test_missing_interface_is_reported_until_it_appears(self):
        server = Server("hold", TestAction)
        wait_until(lambda: self.interfaces() == "run, walk", "the interfaces to announce themselves")
        goal = Client().send("do(hold,1)")
        wait_until(lambda: self.report.message == MISSING, "the interfaces that there are")
        wait_until(lambda: goal.feedback and goal.feedback[-1].status == f"waiting: {MISSING}", "the client's feedback")
        self.assertEqual(self.report.level, DiagnosticStatus.WARN)
        wait_until(lambda: any(MISSING in line for line in self.lines), "the log")
        command = (
            executable("interface"),
            "__name:=hand",
            "_interfaces:={hold: {type: actionlib/TestAction}}",
        )
        with Process(*command):
            handle = server.accept()
            wait_until(lambda: self.interfaces() == "hold, run, walk", "the new one")
            wait_until(lambda: self.report.message == "waits for _action_lib(hold,1,1)", "the end of the warning")
            wait_until(lambda: goal.feedback[-1].status == "pending", "feedback without the warning")
            handle.set_succeeded()
            goal.ends_as(GoalStatus.SUCCEEDED)
        wait_until(lambda: self.interfaces() == "run, walk", "the new one to be gone")
        self.assertEqual(len([line for line in self.lines if MISSING in line]), 1, "it is reported once")


class Misspelt(unittest.TestCase):
    """Each node reports once at its start which of its private parameters it does not read."""

    def check(self, script, values, *words):
        """Start a node with these parameters and another unknown one, and look for words in its only warning."""
        with Process(executable(script), f"__name:=misspelt_{script}", "_zzz:=1", *values) as process:
            lines = process.lines_until("unknown parameters")
        self.assertEqual(len([line for line in lines if "unknown parameters" in line]), 1)
        for word in (*words, "~zzz"):
            self.assertIn(word, lines[-1])
        return lines[-1]

    def test_unread_parameters_of_nodes_without_tf(self):
        errands, office = DATA / "errands.lp", DATA.parents[1] / "worlds" / "office.yaml"
        core = (f"_program_files:=[{errands}]", "_horizon_limt:=7", "_labels:={hall: {}}")
        self.check("core", core, "~horizon_limt (did you mean ~horizon_limit?), ~zzz")
        arm = ("_interfaces:={arm: {type: actionlib/TestAction}}", "_server_timout:=3", "_retries:=1")
        self.check("interface", arm, "~server_timout (did you mean ~server_timeout?), ~zzz")
        self.check("map_server", (f"_map:={office}", "_frame:=x"), "~frame (did you mean ~frame_id?), ~zzz")

    @NEEDS_TF2
    def test_unread_parameters_of_nodes_with_tf(self):
        self.check("office", ("_labels:={hall: [1, 2]}", "_capacty:=3"), "~capacty (did you mean ~capacity?), ~zzz")
        values = ("_controler_frequency:=10", "_global_costmap:={robot_radius: 0.2, robot_radus: 0.3}")
        words = (
            "~controler_frequency (did you mean ~controller_frequency?)",
            "~global_costmap/robot_radus (did you mean ~global_costmap/robot_radius?)",
        )
        self.assertNotIn("~global_costmap/robot_radius (", self.check("move_base", values, *words))

    def test_bare_interface_node_reads_the_shipped_entries(self):
        with Process(executable("interface"), "__name:=given_nothing") as process:
            lines = process.lines_until("move_base needs labels, but ~labels is empty: each of its actions will")
        self.assertIn("~interfaces is not set: reading the entries of ", "".join(lines))


class Suite(unittest.TestSuite):
    def __init__(self):
        super().__init__()
        for case in (Silence, Misspelt):
            self.addTests(unittest.defaultTestLoader.loadTestsFromTestCase(case))


if __name__ == "__main__":
    init_node("silence_test")
    rostest.rosrun("rosoclingo", "silence", "test_silence.Suite", sys.argv)
