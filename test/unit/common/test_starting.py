"""The start of scripts: help, reports of missing modules, and parameters that no code reads."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from rosoclingo.common.parameters import unread
from rosoclingo.common.starting import missing, needed_modules

SCRIPTS = Path(__file__).resolve().parents[3] / "scripts"
#: Parameters in the help of a node, which is its docstring; test_reference.py has the docstrings of all nodes.
PARAMETERS = {
    "core": ["~program_files (list of str, required)", "~horizon_limit (int, default 100)"],
    "map_server": ["~frame_id (str, default", "[MAP.yaml]"],
}


def run(script, *arguments, **environment):
    return subprocess.run(
        [sys.executable, str(SCRIPTS / script), *arguments],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@pytest.mark.slow
@pytest.mark.parametrize("script", PARAMETERS)
def test_start_help_names_parameters_without_a_master(script):
    done = run(script, "--help", ROS_MASTER_URI="http://localhost:1")
    assert done.returncode == 0, done.stderr
    for words in [*PARAMETERS[script], f"rosrun rosoclingo {script} ", "_PARAMETER:=VALUE"]:
        assert words in done.stdout
    assert ":class:" not in done.stdout


def run_without(modules, folder, script, *arguments):
    for module in modules:
        text = f"No module named '{module}'"
        (folder / f"{module}.py").write_text(f"raise ModuleNotFoundError({text!r}, name={module!r})\n")
    return run(script, *arguments, PYTHONPATH=os.pathsep.join([str(folder), os.environ.get("PYTHONPATH", "")]))


@pytest.mark.sampled(2)
@pytest.mark.slow
@pytest.mark.parametrize("script", ["core", "oclingo", "request"])
def test_start_without_clingo_explains_its_installation(script, tmp_path):
    done = run_without(["clingo"], tmp_path, script, "--help")
    if script == "request":
        assert done.returncode in (0, 1)
    else:
        assert done.returncode == 1
        assert done.stderr.startswith(f"{script}: clingo is not installed for {sys.executable} (Python 3.")
        assert done.stderr.rstrip().endswith(f"{sys.executable} -m pip install 'clingo>=5.7'")
    assert "Traceback" not in done.stderr


def test_start_reports_other_missing_modules():
    assert missing("yaml.nodes").endswith(" PyYAML")
    assert "build the workspace and source" in missing("rosoclingo.msg")
    assert "numba is not installed for" in missing("numba.core")
    with pytest.raises(SystemExit, match="nosuchmodule is not installed"), needed_modules():
        import nosuchmodule  # noqa: F401


@pytest.mark.parametrize(
    ("values", "read", "found"),
    [
        ({}, {"a"}, []),
        ({"labels": {"kitchen": {"x": 1}}, "speed": 1}, {"labels", "speed", "map"}, []),
        ({"sped": 1, "zzz": 2}, {"speed"}, ["~sped (did you mean ~speed?)", "~zzz"]),
        (
            {"global_costmap": {"footprnt": [], "inflation": {"radius": 1}, "other": {"x": 1, "y": 2}}},
            {"global_costmap/footprint", "global_costmap/inflation/radius"},
            ["~global_costmap/footprnt (did you mean ~global_costmap/footprint?)", "~global_costmap/other"],
        ),
        ({"status_frequency": 5, "actionlib_server_pub_queue_size": 9}, set(), []),
    ],
)
def test_start_reports_unread_parameters(values, read, found):
    assert unread(values, frozenset(read)) == found
