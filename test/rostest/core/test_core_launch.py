"""core.launch as it stands: a core that cannot start or go on ends its roslaunch; core_killed.test has kills."""

import contextlib
import os
import signal
import sqlite3
import tempfile
import unittest
from pathlib import Path

import rospy
from core_helpers import ERRANDS, start_core
from interface_helpers import PATIENCE, OutputProcess, process_of
from rosoclingo.msg import TaskPlan

NODE = "/rosoclingo"


@contextlib.contextmanager
def core_launch(**arguments):
    """Start a roslaunch of core.launch; Ctrl-C ends it."""
    words = [f"{name}:={value}" for name, value in arguments.items()]
    command = ("bash", "-c", 'exec roslaunch rosoclingo core.launch "$@" 2>&1', "core.launch", *words)
    with tempfile.TemporaryDirectory() as folder, OutputProcess(*command, ROS_HOME=folder) as launch:
        try:
            yield launch
        finally:
            if launch.running:
                launch.signal(signal.SIGINT)
                launch.wait()


class CoreLaunch(unittest.TestCase):
    def ends(self, launch, starts):
        """Return the output of a roslaunch that ends by itself after so many starts of the core."""
        text = launch.wait()[1]
        self.assertEqual(text.count("process[rosoclingo-"), starts, text)
        return text

    @staticmethod
    def wait_for_core():
        rospy.wait_for_message(NODE + "/task_plan", TaskPlan, PATIENCE)

    def test_program_with_a_fault_ends_roslaunch(self):
        with tempfile.NamedTemporaryFile("w", suffix=".lp") as file:
            file.write("#program base.\na(X).\n")
            file.flush()
            with core_launch(programs=f"[{file.name}]") as launch:
                text = self.ends(launch, starts=1)
        for words in (f"{file.name}:2", "unsafe", "a restart cannot help: ending roslaunch"):
            self.assertIn(words, text)

    def test_core_whose_name_is_taken_ends_roslaunch(self):
        with core_launch(programs=f"[{ERRANDS}]") as launch:
            self.wait_for_core()
            with start_core("/", journal="none"):
                self.assertIn("new node registered with same name", self.ends(launch, starts=1))

    def test_refused_journal_ends_roslaunch(self):
        with tempfile.TemporaryDirectory() as folder, core_launch(programs=f"[{ERRANDS}]", journal=folder) as launch:
            self.wait_for_core()
            with contextlib.closing(sqlite3.connect(str(Path(folder) / "journal.db"))) as journal, journal:
                journal.execute("UPDATE header SET run = 'other'")
            os.kill(process_of(NODE), signal.SIGKILL)
            self.assertIn("the header is missing or corrupt", self.ends(launch, starts=2))

    def test_core_without_a_journal_ends_everything(self):
        with core_launch(programs=f"[{ERRANDS}]", journal="none") as launch:
            self.wait_for_core()
            os.kill(process_of(NODE), signal.SIGKILL)
            self.assertIn("REQUIRED process [rosoclingo-", self.ends(launch, starts=1))
