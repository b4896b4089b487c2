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
            handle.set_succeeded()
            goal.ends_as(GoalStatus.SUCCEEDED)
        wait_until(lambda: self.interfaces() == "run, walk", "the new one to be gone")
        self.assertEqual(len([line for line in self.lines if MISSING in line]), 1, "it is reported once")


class Misspelt(unittest.TestCase):
    """Each node reports once at its start which of its private parameters it does not read."""

    def warning_of(self, script, *values):
        command = (executable(script), f"__name:=misspelt_{script}", "_zzz:=1", *values)
        with Process(*command) as process:
            lines = process.lines_until("unknown parameters")
        self.assertEqual(len([line for line in lines if "unknown parameters" in line]), 1)
        return lines[-1]

    def test_unread_parameters_of_core(self):
        line = self.warning_of(
            "core", f"_program_files:=[{DATA / 'errands.lp'}]", "_horizon_limt:=7", "_labels:={hall: {}}"
        )
        self.assertIn("~horizon_limt (did you mean ~horizon_limit?), ~zzz", line)

    def test_unread_parameters_of_bare_interface_node(self):
        with Process(executable("interface"), "__name:=given_nothing") as process:
            lines = process.lines_until("move_base needs labels, but ~labels is empty: each of its actions will")
        self.assertIn("~interfaces is not set: reading the entries of ", "".join(lines))

    def test_unread_parameters_of_interface(self):
        entry = "{arm: {type: actionlib/TestAction}}"
        line = self.warning_of("interface", f"_interfaces:={entry}", "_server_timout:=3", "_retries:=1")
        self.assertIn("~server_timout (did you mean ~server_timeout?), ~zzz", line)

    @NEEDS_TF2
    def test_unread_parameters_of_office(self):
        line = self.warning_of("office", "_labels:={hall: [1, 2]}", "_capacty:=3")
        self.assertIn("~capacty (did you mean ~capacity?), ~zzz", line)

    def test_unread_parameters_of_map_server(self):
        line = self.warning_of("map_server", f"_map:={DATA.parents[1] / 'worlds' / 'office.yaml'}", "_frame:=x")
        self.assertIn("~frame (did you mean ~frame_id?), ~zzz", line)

    @NEEDS_TF2
    def test_unread_parameters_of_move_base(self):
        values = ("_controler_frequency:=10", "_global_costmap:={robot_radius: 0.2, robot_radus: 0.3}")
        line = self.warning_of("move_base", *values)
        self.assertIn("~controler_frequency (did you mean ~controller_frequency?)", line)
        self.assertIn("~global_costmap/robot_radus (did you mean ~global_costmap/robot_radius?)", line)
        self.assertNotIn("~global_costmap/robot_radius (", line)


class Suite(unittest.TestSuite):
    def __init__(self):
        super().__init__()
        for case in (Silence, Misspelt):
            self.addTests(unittest.defaultTestLoader.loadTestsFromTestCase(case))


if __name__ == "__main__":
    init_node("silence_test")
    rostest.rosrun("rosoclingo", "silence", "test_silence.Suite", sys.argv)
