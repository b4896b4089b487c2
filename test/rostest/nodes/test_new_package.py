"""The command new: catkin builds the package, its scenarios pass its own test, and a wrong one fails there."""

import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import tf2_ros  # noqa: F401 - the launched nodes need it: this file is skipped without it
from interface_helpers import PATIENCE, executable

BUILD = 'catkin_make -C "$1" -DPYTHON_EXECUTABLE="$(which python3)"'
TEST = 'source "$1/devel/setup.bash" && rostest guard scenarios.test'


class NewPackage(unittest.TestCase):
    def test_new_package_builds_and_tests_its_scenarios(self):
        with tempfile.TemporaryDirectory() as workspace:
            sources = Path(workspace, "src")
            sources.mkdir()
            made = self.run_until_done([executable("new"), "guard", "--folder", str(sources)])
            self.assertIn("guard/encodings/guard.lp", made)
            self.run_until_done(["bash", "-c", BUILD, "build", workspace])
            scenarios = sources / "guard" / "scenarios"
            wrong = (scenarios / "closed.yaml").read_text().replace("[succeeded, ", "[aborted, ")
            (scenarios / "wrong.yaml").write_text(wrong)  # played last
            output = self.run_until_done(["bash", "-c", TEST, "test", workspace], fails=True)
            self.assertIn("expected ['aborted', 'rejected'", output)
            self.assertEqual(set(re.findall(r": (\w+)\.yaml$", output, re.MULTILINE)), {"wrong"}, output)

    def run_until_done(self, command, fails=False):
        """Return a command's output, with the expected exit code."""
        done = subprocess.run(
            command, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=PATIENCE
        )
        self.assertEqual(done.returncode != 0, fails, f"{command}\n{done.stdout}")
        return done.stdout
