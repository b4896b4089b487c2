"""Stage at a given speed: its world file, its command, and the messages and exit codes of a replacement."""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from rosoclingo.robot.simulation import WorldError
from rosoclingo.robot.simulation.stage_pace import paced_world, read_stage_world

ROOT = Path(__file__).resolve().parents[4]
WORLD = """\
# speedup 3 in a comment, and "half a text
interval_sim 100  # ms
speedup 2.5 # the old one
include "parts/robot.inc"
window ( size [ 600 400 ] speedup 7 )
model ( name "bitmap" bitmap "maps/a map.png" ) model ( bitmap "/b.png" bitmap "" )
"""


def test_stage_pace_changes_speed_and_resolves_files():
    text = paced_world(WORLD, "/worlds", 10.0)
    assert text.count("speedup 10\n") == 1
    assert "2.5" not in text
    assert 'include "/worlds/parts/robot.inc"' in text
    assert 'bitmap "/worlds/maps/a map.png"' in text
    assert 'name "bitmap" bitmap' in text
    assert 'bitmap "/b.png" bitmap ""' in text
    assert "window ( size [ 600 400 ] speedup 7 )" in text
    assert '# speedup 3 in a comment, and "half a text\n' in text
    assert paced_world(text, "/elsewhere", 10.0).count("speedup 10") == 1
    with pytest.raises(WorldError, match="/no/such\\.world cannot be read: No such file"):
        read_stage_world("/no/such.world")


STAGE = """#!/bin/sh
echo "$@"; echo "display $DISPLAY"
for last in "$@"; do case $last in *.world) cat "$last";; esac; done
trap 'exit 7' INT
{then}
"""


@pytest.fixture
def stage(tmp_path):
    """Run the script with a stage_ros of the test's; without one if ``then`` is None."""
    if not shutil.which("rosrun"):
        pytest.skip("no rosrun")

    def start(*arguments, then="exit 3", path=None):
        package = tmp_path / "stage_ros"
        if then is not None:
            package.mkdir()
            (package / "package.xml").write_text(
                '<package format="2"><name>stage_ros</name><version>1.0.0</version><description>a test\'s</description>'
                '<maintainer email="nobody@example.org">nobody</maintainer><license>none</license></package>'
            )
            (package / "stageros").write_text(STAGE.format(then=then))
            (package / "stageros").chmod(0o755)
        (tmp_path / "a.world").write_text(WORLD)
        environment = dict(os.environ, ROS_PACKAGE_PATH=f"{tmp_path}:{os.environ.get('ROS_PACKAGE_PATH', '')}")
        environment["PYTHONPATH"] = os.pathsep.join(sys.path)
        environment.pop("DISPLAY", None)
        command = [sys.executable, ROOT / "scripts" / "stage", *arguments, tmp_path / "a.world"]
        return subprocess.Popen(
            [*map(str, command), "__name:=stageros"], env={**environment, **({"PATH": path} if path else {})},
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        )  # fmt: skip

    return start


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("xvfb-run"), reason="no xvfb-run")
def test_stage_pace_starts_a_screen_and_returns_exit_code(stage):
    process = stage("--speed", "4")
    said, _ = process.communicate(timeout=120)
    assert process.returncode == 3
    words, display, *world = said.splitlines()
    assert words.endswith("a.world __name:=stageros")
    assert not words.startswith("-g")
    assert display.startswith("display :")
    assert world[-1] == "speedup 4"
    assert not os.path.exists(words.split()[0]), "its own world file is removed"


@pytest.mark.slow
def test_stage_pace_ends_stage_with_itself(stage):
    """Unlimited speed, which needs no screen."""
    process, lines = stage("--speed", "0", "-u", then="echo ready; while :; do sleep 0.05; done"), []
    while "ready\n" not in lines:
        lines.append(process.stdout.readline())
    assert lines[0].startswith("-g -u ")
    assert lines[1] == "display \n"
    os.killpg(process.pid, signal.SIGINT)
    process.communicate(timeout=120)
    assert process.returncode == 7


@pytest.mark.slow
@pytest.mark.parametrize(
    ("there", "speed", "words"),
    [
        (False, "0", ["there is no package stage_ros: source the setup.bash"]),
        (True, "1", ["there is no xvfb-run", "stage_window:=true"]),
    ],
)
def test_stage_pace_reports_missing_programs(stage, tmp_path, there, speed, words):
    process = stage("--speed", speed, then="exit 3" if there else None, path=str(tmp_path))
    _, said = process.communicate(timeout=120)
    assert process.returncode == 1
    assert all(part in said for part in words)
