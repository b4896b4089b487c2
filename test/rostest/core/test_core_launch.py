#!/usr/bin/env python3
"""core.launch as it stands: a killed core comes back, a core that cannot start ends its roslaunch."""

import contextlib
import os
import signal
import sqlite3
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib.action_client import CommState
from actionlib_msgs.msg import GoalStatus
from rosoclingo.msg import TaskPlan

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import ERRANDS, Client, ManualInterfaces, start_core
from interface_helpers import PATIENCE, init_node, kill, process_of, wait_until

NODE = "/rosoclingo"


class Launched:
    """A roslaunch of core.launch; ``text`` is its output so far."""

    def __init__(self, folder, arguments):
        self._log = Path(folder) / "roslaunch.log"
        words = [f"{name}:={value}" for name, value in arguments.items()]
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(
                ["roslaunch", "rosoclingo", "core.launch", *words],
                env={**os.environ, "ROS_HOME": str(folder)},
                stdout=log,
                stderr=log,
                start_new_session=True,
            )

    @property
    def text(self):
        return self._log.read_text(errors="replace")

    @property
    def lives(self):
        return self._process.poll() is None

    @property
    def starts(self):
        """Return how often it has started the core."""
        return self.text.count("process[rosoclingo-")

    def ends(self):
        """Wait until it has ended by itself, with all its children."""
        self._process.wait(PATIENCE)
        return self

    def end(self):
        """Press Ctrl-C, and kill it if it ignores that."""
        try:
            os.killpg(self._process.pid, signal.SIGINT)
            self._process.wait(PATIENCE)
        except ProcessLookupError:
            pass


@contextlib.contextmanager
def core_launch(**arguments):
    """Start a roslaunch of core.launch."""
    with tempfile.TemporaryDirectory() as folder:
        launched = Launched(folder, arguments)
        try:
            yield launched
        finally:
            launched.end()


class CoreLaunch(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        init_node("core_launch_test")

    @staticmethod
    def wait_for_core():
        rospy.wait_for_message(NODE + "/task_plan", TaskPlan, PATIENCE)

    def test_program_with_a_fault_ends_roslaunch(self):
        with tempfile.NamedTemporaryFile("w", suffix=".lp") as file:
            file.write("#program base.\na(X).\n")
            file.flush()
            with core_launch(programs=f"[{file.name}]") as launched:
                text = launched.ends().text
                self.assertEqual(launched.starts, 1, text)
        for words in (f"{file.name}:2", "unsafe", "a restart cannot help: ending roslaunch"):
            self.assertIn(words, text)

    def test_killed_core_resumes_until_its_name_is_taken(self):
        with core_launch(programs=f"[{ERRANDS}]") as launched:
            hands, client = ManualInterfaces(), Client()
            hands.wait_for(NODE)
            goal = client.send("do(walk,1)")
            command = hands.take()
            kill(NODE)
            self.assertEqual(hands.take(), command)
            hands.at_once = True  # repeatedly, as the new core is perhaps not yet connected
            wait_until(lambda: hands.succeed(command) or CommState.DONE in goal.states, "the goal to end")
            goal.ends_as(GoalStatus.SUCCEEDED)
            self.assertEqual(len(set(hands.runs)), 1)
            self.assertTrue(launched.lives)
            self.assertEqual(launched.starts, 2)
            with start_core("/", journal="none"):
                self.assertIn("new node registered with same name", launched.ends().text)
            self.assertEqual(launched.starts, 2)

    def test_refused_journal_ends_roslaunch(self):
        with tempfile.TemporaryDirectory() as folder, core_launch(programs=f"[{ERRANDS}]", journal=folder) as launched:
            self.wait_for_core()
            with contextlib.closing(sqlite3.connect(str(Path(folder) / "journal.db"))) as journal, journal:
                journal.execute("UPDATE header SET run = 'other'")
            os.kill(process_of(NODE), signal.SIGKILL)
            self.assertIn("the header is missing or corrupt", launched.ends().text)
            self.assertEqual(launched.starts, 2)

    def test_core_without_a_journal_ends_everything(self):
        with core_launch(programs=f"[{ERRANDS}]", journal="none") as launched:
            self.wait_for_core()
            os.kill(process_of(NODE), signal.SIGKILL)
            self.assertIn("REQUIRED process [rosoclingo-", launched.ends().text)
            self.assertEqual(launched.starts, 1)


if __name__ == "__main__":
    rostest.rosrun("rosoclingo", "core_launch", CoreLaunch, sys.argv)
