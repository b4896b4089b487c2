"""What ``./dev`` says before any set-up."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SYSTEM = "/usr/bin:/bin"


def dev(*arguments, **variables):
    environment = {**os.environ, "ROSOCLINGO_HOME": "/proc/no/folder", **variables}  # where nothing can be set up
    done = subprocess.run([ROOT / "dev", *arguments], env=environment, capture_output=True, text=True, timeout=60)
    return done.returncode, done.stderr


def test_an_unknown_command_is_told_the_known_ones():
    code, said = dev("nosuch")
    assert code == 1
    assert "unknown command: nosuch" in said
    assert "demo test lint bench exec exec-install exec-python38 shell setup help" in said


def test_an_unknown_scenario_is_told_the_known_ones_before_any_set_up():
    code, said = dev("demo", "nosuch")
    assert code == 2
    assert "no such scenario: nosuch" in said
    for path in (ROOT / "config" / "scenarios").glob("*.yaml"):
        assert f" {path.stem} " in said


HOUSE = ROOT / "config" / "scenarios" / "house.yaml"


@pytest.mark.parametrize("scenario", ["house", str(HOUSE), "--help", "rviz:=true"])
def test_a_known_scenario_is_set_up_for(scenario):
    _, said = dev("demo", scenario)
    assert "/proc/no/folder" in said
    assert "scenario" not in said


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["nosuch"], "no such bench: nosuch; there are cancels "),
        (["oclingo", "--rounds", "0"], "--rounds is at least 1"),
        (["oclingo", "--against", "nosuch"], "no such commit: nosuch"),
    ],
)
def test_a_wrong_bench_is_told_before_any_set_up(arguments, told):
    code, said = dev("bench", *arguments)
    assert code == 2
    assert told in said
    assert "/proc/no/folder" not in said


def test_a_known_bench_is_set_up_for():
    _, said = dev("bench", "oclingo")
    assert "/proc/no/folder" in said


def test_help_needs_no_set_up():
    code, said = dev("bench", "--help")
    assert code == 0
    assert not said


def test_what_is_edited_while_it_runs_does_not_reach_it(tmp_path):
    script = Path(shutil.copy(str(ROOT / "dev"), str(tmp_path)))
    editor = tmp_path / "cat"  # which prints the usage
    editor.write_text(f'#!/bin/sh\necho "echo edited" >>"{script}"\nexec /bin/cat "$@"\n')
    editor.chmod(0o755)
    variables = {**os.environ, "PATH": f"{tmp_path}:{SYSTEM}"}
    done = subprocess.run([script, "help"], env=variables, capture_output=True, text=True, check=False, timeout=60)
    assert script.read_text().endswith("echo edited\n")
    assert done.returncode == 0
    assert "usage: ./dev" in done.stdout
    assert not done.stdout.endswith("edited\n")


def python38(path, body):
    shim = path / "python3.8"
    shim.write_text(f"#!/bin/sh\n{body}\n")
    shim.chmod(0o755)
    return dev("exec-python38", "true", PATH=f"{path}:{SYSTEM}", PYENV_ROOT=str(path / "none"))


SHIM = "echo 'pyenv: python3.8: command not found' >&2; exit 127"
OTHER = 'exec /usr/bin/python3 "$@"'


@pytest.mark.skipif(bool(shutil.which("python3.8", path=SYSTEM)), reason="the distribution has one that works")
@pytest.mark.parametrize("body", [SHIM, OTHER, "exit 1"])
def test_a_python38_that_does_not_work_counts_as_none(tmp_path, body):
    code, said = python38(tmp_path, body)
    assert code == 3
    assert "no python3.8" in said


def test_one_that_works_is_found_on_path(tmp_path):
    code, said = python38(tmp_path, "exit 0")
    assert code != 3 or "ROS's own Python is 3.8" in said
