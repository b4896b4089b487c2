"""The messages of ``./dev`` before any set-up."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def dev(*arguments, **variables):
    environment = {**os.environ, "ROSOCLINGO_HOME": "/proc/no/folder", **variables}  # where nothing can be set up
    done = subprocess.run([ROOT / "dev", *arguments], env=environment, capture_output=True, text=True, timeout=300)
    return done.returncode, done.stderr


def test_dev_unknown_command_lists_the_known_ones():
    code, said = dev("nosuch")
    assert code == 1
    assert "unknown command: nosuch" in said
    assert "demo test lint bench docs exec exec-install exec-python38 shell setup help" in said


@pytest.mark.parametrize("command", ["demo", "shell", "setup"])
def test_dev_commands_report_a_folder_that_cannot_be_made(command):
    code, said = dev(command)
    assert code == 1
    assert "/proc/no/folder" in said
    assert "set ROSOCLINGO_HOME" in said


# ---- overlays: the user's workspaces ------------------------------------------------------------------------------

BUILT = Path(os.environ.get("VIRTUAL_ENV", "/none")).parent / "ws" / "devel"
PACKAGE = """<package format="2"><name>{name}</name><version>1.0.0</version><description>a test's</description>
<maintainer email="nobody@example.org">nobody</maintainer><license>none</license></package>"""


def overlay(path, name, says):
    """Return a catkin workspace with one package, which has a node."""
    space = path / "devel"
    (path / "src" / name).mkdir(parents=True)
    (path / "src" / name / "package.xml").write_text(PACKAGE.format(name=name))
    (space / "lib" / name).mkdir(parents=True)
    node = space / "lib" / name / "node"
    node.write_text(f"#!/bin/sh\necho {says}\n")
    node.chmod(0o755)
    for file in ("setup.bash", "setup.sh", "_setup_util.py"):
        shutil.copy(str(BUILT / file), str(space))
    (space / ".catkin").write_text(str(path / "src"))
    return path


needs_workspace = pytest.mark.skipif(
    not (BUILT / "_setup_util.py").is_file() or BUILT.parents[1].name == "python38", reason="no workspace of ./dev's"
)


@pytest.mark.slow
@needs_workspace
def test_dev_unknown_scenario_lists_the_known_ones():
    done = subprocess.run([ROOT / "dev", "demo", "nosuch"], capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 2
    assert "no such scenario: nosuch" in done.stderr
    for path in (ROOT / "config" / "scenarios").glob("*.yaml"):
        assert path.stem in done.stderr


@pytest.mark.slow
@needs_workspace
def test_dev_overlay_packages_are_found(tmp_path):
    first = overlay(tmp_path / "first", "stage_ros", "first")
    second = overlay(tmp_path / "second", "stage_ros", "second")
    third = overlay(tmp_path / "third", "rosoclingo", "third")

    def in_overlays(*words, **variables):
        found = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        command = [ROOT / "dev", *words, "exec", "bash", "-c", "rosrun stage_ros node; rospack find rosoclingo"]
        done = subprocess.run(command, env={**found, **variables}, capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        return done.stdout.split()

    own = str(BUILT.parent / "src" / "rosoclingo")
    assert in_overlays("--overlay", first, "--overlay", second) == ["first", own]
    assert in_overlays(ROSOCLINGO_OVERLAY=f"{second / 'devel'}:{first}:{third}") == ["second", own]
    assert in_overlays("--overlay", first, ROSOCLINGO_OVERLAY=str(second)) == ["first", own]


def test_dev_invalid_overlay_is_refused_before_set_up(tmp_path):
    for code, said in (
        dev("--overlay", str(tmp_path), "exec", "true"),
        dev("demo", "true", ROSOCLINGO_OVERLAY=str(tmp_path)),
    ):
        assert code == 1
        assert f"the overlay {tmp_path} has no setup.bash" in said
        assert "devel or install folder" in said


@pytest.mark.parametrize("arguments", [["--overlay"], ["--overlay", "/tmp", "test"]])
def test_dev_overlay_is_refused_where_impossible(arguments):
    code, said = dev(*arguments)
    assert code == 1
    assert "--overlay" in said or "does not support overlays" in said
