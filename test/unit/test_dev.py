"""The messages of ``./dev`` before any set-up."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SYSTEM = "/usr/bin:/bin"


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


def test_dev_edits_while_it_runs_have_no_effect(tmp_path):
    script = Path(shutil.copy(str(ROOT / "dev"), str(tmp_path)))
    editor = tmp_path / "cat"  # which prints the usage
    editor.write_text(f'#!/bin/sh\necho "echo edited" >>"{script}"\nexec /bin/cat "$@"\n')
    editor.chmod(0o755)
    variables = {**os.environ, "PATH": f"{tmp_path}:{SYSTEM}"}
    done = subprocess.run([script, "help"], env=variables, capture_output=True, text=True, check=False, timeout=300)
    assert script.read_text().endswith("echo edited\n")
    assert done.returncode == 0
    assert "usage: ./dev" in done.stdout
    assert not done.stdout.endswith("edited\n")


@pytest.mark.skipif(bool(shutil.which("python3.8", path=SYSTEM)), reason="the distribution has one that works")
@pytest.mark.parametrize("body", ["exit 127", 'exec /usr/bin/python3 "$@"'])
def test_dev_ignores_a_python38_that_does_not_work(tmp_path, body):
    shim = tmp_path / "python3.8"
    shim.write_text(f"#!/bin/sh\n{body}\n")
    shim.chmod(0o755)
    code, said = dev("exec-python38", "true", PATH=f"{tmp_path}:{SYSTEM}", PYENV_ROOT=str(tmp_path / "none"))
    assert code == 3
    assert "no python3.8" in said


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


def test_dev_compiled_file_times_follow_from_contents(tmp_path):
    """So numba's compiled code stays valid in another clone of the same sources."""
    function = (ROOT / "dev").read_text().partition("\nsame_times() {")[2].partition("\n}\n")[0]
    times = []
    for number, text in enumerate(("same", "same", "changed")):
        file = tmp_path / f"a clone {number}" / "src" / "rosoclingo" / "robot" / "navigation" / "compiled" / "loop.py"
        file.parent.mkdir(parents=True)
        file.write_text(text)
        script = f"set -eu; SOURCE=$1; same_times() {{{function}\n}}; same_times"
        subprocess.run(["bash", "-c", script, "-", str(file.parents[5])], check=True, timeout=300)
        times.append(file.stat().st_mtime)
    assert times[0] == times[1] != times[2]
    assert max(times) < 1e9
