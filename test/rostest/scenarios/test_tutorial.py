"""doc/tutorial.md: its files are written, its commands run, and the outputs compared with the page."""

import contextlib
import os
import re
import shlex
import signal
import tempfile
import unittest
from pathlib import Path

import rospy
import tf2_ros  # noqa: F401 - the launched nodes need it: this file is skipped without it
from actionlib_msgs.msg import GoalStatusArray
from interface_helpers import PATIENCE, OutputProcess, Process, executable

PAGE = (Path(__file__).resolve().parents[3] / "doc" / "tutorial.md").read_text()
STAYING = ("roslaunch", "python3")  # these commands run in separate terminals, until the end
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
CODES = {"canceled": 2, "rejected": 3, "aborted": 4}  # of the exit, by the last printed word


def without_cycles(line):
    """Remove the number of cycles, which depends on the time of Ctrl-C."""
    return re.sub(r"cycle \d+", "cycle N", line.rstrip())


def is_late(line):
    """Return whether a line says that the simulator comes later, as on a slow machine."""
    return line.startswith("ROS time has not begun")


class Tutorial(unittest.TestCase):
    def setUp(self):
        self.stack = contextlib.ExitStack()
        self.addCleanup(self.stack.close)
        self.folder = self.stack.enter_context(tempfile.TemporaryDirectory())
        self.environment = {}

    def test_tutorial_shows_the_real_output(self):
        files, commands, end = [], 0, 0
        for match in BLOCK.finditer(PAGE):
            if match.group(1) == "console":
                commands += self.play(match.group(2))
            else:
                paragraph = PAGE[end : match.start()].strip().rpartition("\n\n")[2]
                files.append(re.search(r"`(garden/[\w/]+\.\w+)`", paragraph).group(1))
                Path(self.folder, files[-1]).write_text(match.group(2))
            end = match.end()
        expected = ["encodings/garden.lp", "morning.txt", "config/labels.yaml", "config/interfaces.yaml", "pump.py"]
        expected = [f"garden/{name}" for name in [*expected, "scenarios/float.yaml"]]
        self.assertEqual(files, expected)
        self.assertEqual(commands, PAGE.count("\n$ "))

    def play(self, block):
        """Run the commands of a console block, each with its expected output below it; return their number."""
        parts = re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]
        for part in parts:
            command, *shown = part.split("\n")[:-1]
            words = shlex.split(command)
            if words[:2] == ["rosrun", "rosoclingo"]:
                words = [executable(words[2]), *words[3:]]
            if words[0] == "export":
                name, value = words[1].split("=")
                self.environment[name] = value.replace("$PWD", self.folder).replace(f"${name}", os.environ[name])
            elif words[0] in STAYING:
                terminal = ("bash", "-c", 'exec "$@" 2>&1', "terminal", *words)  # nobody reads its errors
                process = self.stack.enter_context(Process(*terminal, cwd=self.folder, **self.environment))
                self.stack.callback(self.end, process)
                if words[0] == "roslaunch":
                    rospy.wait_for_message("rosoclingo/status", GoalStatusArray, PATIENCE)
            else:
                self.compare(command, shown, *self.output(words, interrupted="^C" in shown))
        return len(parts)

    def compare(self, command, shown, code, lines):
        """Check that the shown lines come in this order, with others only at three dots."""
        message = "{}\nprinted\n{}".format(command, "\n".join(lines))
        wanted = [".*" if line in ("...", "^C") else re.escape(without_cycles(line)) + "\n" for line in shown]
        printed = "".join(without_cycles(line) + "\n" for line in lines)
        if wanted:
            self.assertIsNotNone(re.fullmatch("".join(wanted), printed, re.DOTALL), message)
        self.assertEqual(code, CODES.get(lines[-1].partition(":")[0], 0) if lines else 0, message)

    def output(self, words, interrupted):
        """Return exit code and printed lines; press Ctrl-C after the first line, if the page does so."""
        with OutputProcess(*words, cwd=self.folder, **self.environment) as process:
            lines = process.lines_until("") if interrupted else []
            while lines and is_late(lines[-1]):
                lines = process.lines_until("")
            if interrupted:
                process.signal(signal.SIGINT)
            code, rest = process.wait()
        return code, [line.rstrip() for line in [*lines, *rest.splitlines()] if not is_late(line)]

    @staticmethod
    def end(process):
        """Press Ctrl-C in a terminal, and wait."""
        process.signal(signal.SIGINT)
        process.wait()
