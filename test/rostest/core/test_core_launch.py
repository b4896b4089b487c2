#!/usr/bin/env python3
"""core.launch as it stands: a killed core comes back, a core that cannot start ends its roslaunch."""

import contextlib
import os
import signal
import socket
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

from core_helpers import Client, ManualInterfaces
from interface_helpers import PATIENCE, Process, executable, init_node, is_another, process_of, wait_until

ERRANDS = str(Path(__file__).resolve().parents[2] / "data" / "errands.lp")
NODE = "/rosoclingo"


class Launched:
    """A roslaunch of core.launch; ``text`` is its output so far."""

    def __init__(self, folder, arguments, environment, port):
        self._log = Path(folder) / "roslaunch.log"
        words = [*(["-p", str(port)] if port else []), "rosoclingo", "core.launch"]
        words += [f"{name}:={value}" for name, value in arguments.items()]
        home = {"ROS_HOME": str(folder), **environment}
        if port:
            home["ROS_MASTER_URI"] = f"http://localhost:{port}"
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(
                ["roslaunch", *words],
                env={**os.environ, **home},
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


def free_port():
    with socket.socket() as one:
        one.bind(("localhost", 0))
        return one.getsockname()[1]


@contextlib.contextmanager
def core_launch(environment=None, port=None, **arguments):
    """Start a roslaunch of core.launch, with its own master if a port is given."""
    with tempfile.TemporaryDirectory() as folder:
        launched = Launched(folder, arguments, environment or {}, port)
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

    def kill(self):
        """Kill the core, and wait for the next one."""
        process = process_of(NODE)
        os.kill(process, signal.SIGKILL)
        wait_until(lambda: is_another(NODE, process), "the core to be started again")

    def ends_at_once(self, launched, *words):
        """Check that it has ended after one start, and has given the reason."""
        text = launched.ends().text
        for word in words:
            self.assertIn(word, text)
        self.assertEqual(launched.starts, 1, text)
        self.assertIn("a restart cannot help: ending roslaunch", text)

    def test_program_with_a_fault_ends_roslaunch(self):
        with tempfile.NamedTemporaryFile("w", suffix=".lp") as file:
            file.write("#program base.\na(X).\n")
            file.flush()
            with core_launch(port=free_port(), programs=f"[{file.name}]") as launched:
                self.ends_at_once(launched, f"{file.name}:2", "unsafe")

    def test_bad_parameters_end_roslaunch(self):
        with core_launch(core_params="{horizon_limit: 0}") as launched:
            self.ends_at_once(launched, "~horizon_limit: must be an integer of at least 1, not 0")

    def test_missing_module_ends_roslaunch(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "clingo.py").write_text("raise ModuleNotFoundError('no clingo', name='clingo')\n")
            path = os.pathsep.join([folder, os.environ.get("PYTHONPATH", "")])
            with core_launch({"PYTHONPATH": path}) as launched:
                self.ends_at_once(launched, "core: clingo is not installed for")

    def test_killed_core_resumes_until_its_name_is_taken(self):
        with core_launch(programs=f"[{ERRANDS}]") as launched:
            hands, client = ManualInterfaces(), Client()
            hands.wait_for(NODE)
            goal = client.send("do(walk,1)")
            command = hands.take()
            self.kill()
            self.assertEqual(hands.take(), command)
            hands.at_once = True  # repeatedly, as the new core is perhaps not yet connected
            wait_until(lambda: hands.succeed(command) or CommState.DONE in goal.states, "the goal to end")
            goal.ends_as(GoalStatus.SUCCEEDED)
            self.assertEqual(len(set(hands.runs)), 1)
            self.assertTrue(launched.lives)
            self.assertEqual(launched.starts, 2)
            with Process(executable("core"), "__name:=rosoclingo", f"_program_files:=[{ERRANDS}]", "_journal:=none"):
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
