#!/usr/bin/env python3
"""The core's journal cannot be written: the robot goes on, it is told, and the journal is back when there is room."""

import os
import re
import shutil
import signal
import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib.action_client import CommState
from actionlib_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticStatus
from rosgraph_msgs.msg import Log

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client, Hands
from interface_helpers import (
    Process,
    executable,
    full_disk,
    init_node,
    is_another,
    process_of,
    wait_for_diagnosis,
    wait_until,
)

ERRANDS = str(Path(__file__).resolve().parents[2] / "data" / "errands.lp")
NODE = "/rosoclingo"


def warns(words):
    return lambda one: one.level == DiagnosticStatus.WARN and re.search(words, one.message)


class CoreDisk(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.journal = Path(cls.folder) / "journal.db"
        cls.stale = Path(f"{cls.journal}.stale")
        cls.said = []
        cls.log = rospy.Subscriber("/rosout", Log, lambda message: cls.said.append(message.msg), queue_size=None)
        cls.hands, cls.client = Hands(), Client()

    def setUp(self):
        self.hands.wait_for(NODE)
        self.hands.at_once = False
        self.hands.clear()
        self.said.clear()

    def begin(self, text):
        """A goal, and its first action."""
        goal = self.client.send(text)
        wait_until(goal.has_arrived, "the goal to arrive")
        return goal, self.hands.take()

    def kill(self):
        """Kill the core and wait for the next one; returns the runs that there have been before."""
        process, runs = process_of(NODE), set(self.hands.runs)
        os.kill(process, signal.SIGKILL)
        wait_until(lambda: is_another(NODE, process), "the core to be started again")
        return runs

    def wait_for_trouble(self):
        wait_for_diagnosis(
            "rosoclingo: core", warns(f"the journal {self.journal} cannot be written: disk I/O error"), "the trouble"
        )

    def test_the_robot_goes_on_and_the_journal_is_back_when_there_is_room(self):
        with full_disk(process_of(NODE)):
            first, command = self.begin("do(walk,1)")
            self.wait_for_trouble()
            self.assertTrue(self.stale.exists())
            self.assertFalse(self.journal.exists())
            self.hands.succeed(command)
            first.ends_as(GoalStatus.SUCCEEDED)
            second, command = self.begin("do(walk,2)")
        wait_until(self.journal.exists, "the journal to be written again, though nothing happens")
        wait_for_diagnosis("rosoclingo: core", lambda one: one.level == DiagnosticStatus.OK, "the end of the trouble")
        wait_until(lambda: any("the journal is written again" in line for line in list(self.said)), "word of it")
        runs = self.kill()
        self.assertEqual(self.hands.take(), command)
        self.hands.at_once = True  # and again, as the new core may not hear yet
        wait_until(lambda: self.hands.succeed(command) or CommState.DONE in second.states, "the goal to end")
        second.ends_as(GoalStatus.SUCCEEDED)
        self.assertEqual(set(self.hands.runs), runs)

    def test_a_core_that_is_killed_on_a_full_disk_begins_anew_and_says_so(self):
        with full_disk(process_of(NODE)):
            lost, _ = self.begin("do(walk,3)")
            self.wait_for_trouble()
            runs = self.kill()
        wait_until(lambda: set(self.hands.runs) - runs, "another run")
        wait_until(lambda: any(f"before {self.stale} could have all" in line for line in list(self.said)), "a warning")
        self.assertEqual(lost.wait()[0], GoalStatus.LOST)
        goal, command = self.begin("do(walk,4)")
        self.hands.at_once = True
        wait_until(lambda: self.hands.succeed(command) or CommState.DONE in goal.states, "the goal to end")
        goal.ends_as(GoalStatus.SUCCEEDED)

    def test_a_folder_that_cannot_be_made(self):
        values = [f"_program_files:=[{ERRANDS}]", "_journal:=/proc/rosoclingo"]
        with Process(executable("core"), "__name:=rosoclingo", "__ns:=nowhere", *values) as process:
            hands = Hands("nowhere/")
            hands.wait_for("/nowhere/rosoclingo")
            words = "no journal is kept in /proc/rosoclingo: No such file or directory"
            wait_for_diagnosis("nowhere/rosoclingo: core", warns(words), "the trouble")
            goal = Client("nowhere/rosoclingo").send("do(walk,1)")
            hands.succeed(hands.take())
            goal.ends_as(GoalStatus.SUCCEEDED)
            process.signal(signal.SIGINT)
            code, error = process.wait()
        self.assertEqual(code, 0, error)
        self.assertEqual(error.count(words), 1, error)


if __name__ == "__main__":
    CoreDisk.folder = rospy.myargv()[1]
    init_node("core_disk_test")
    try:
        rostest.rosrun("rosoclingo", "core_disk", CoreDisk, sys.argv)
    finally:
        shutil.rmtree(CoreDisk.folder, ignore_errors=True)
