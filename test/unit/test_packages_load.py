"""The packages' __init__ modules: every name exists, and small imports load little."""

import importlib
import importlib.util
import os
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

SOURCES = Path(__file__).resolve().parents[2] / "src"
OTHERS = ("common", "interfaces", "nodes", "oclingo", "runs")


@pytest.mark.parametrize("package", ["rosoclingo.robot.navigation", "rosoclingo.robot.simulation"])
def test_packages_export_every_name(package):
    module = importlib.import_module(package)
    for name in module.__all__:
        assert getattr(module, name).__name__ == name or not hasattr(getattr(module, name), "__name__")
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        module.nonsense  # noqa: B018


@pytest.mark.slow
def test_packages_stream_command_loads_only_its_needs(tmp_path):
    """A new process loads and compiles each module that it imports."""
    (tmp_path / "program.lp").write_text("#program cumulative(t).\n#external e(t).\n#program volatile(t).\n")
    (tmp_path / "updates.str").write_text("#step 1. e(1). #endstep.")
    words = [str(SOURCES.parent / "scripts" / "oclingo"), "program.lp", "--stream", "updates.str"]
    code = (
        "import runpy, sys\ndel sys.argv[0]\ntry:\n    runpy.run_path(sys.argv[0], run_name='__main__')\n"
        "finally:\n    print(*sys.modules, sep='\\n')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *words],
        env=dict(os.environ, PYTHONPATH=str(SOURCES)),
        cwd=str(tmp_path),
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    loaded = set(done.stdout.splitlines())
    assert {"rosoclingo.planning.workers.pool", "rosoclingo.oclingo.gringo3.dialect"} <= loaded
    rooms = (
        "checking.check_command",
        "oclingo.service.server",
        "oclingo.gringo3.file_translator",
        "planning.solver",
    )
    folders = ("planning.explaining", "planning.strategies", "golog", "reasoning")
    assert not loaded & {f"rosoclingo.{one}" for one in (*rooms, *folders)}
    assert not loaded & {"logging", "lark"}


WITHOUT = """
import importlib, sys
for name in sys.argv[1].split(","):
    sys.modules[name] = None  # as if it were not installed
for name in sys.argv[2].split(","):
    try:
        importlib.import_module(name)
    except ModuleNotFoundError as error:
        print(name, "lacks", error.name)
"""


@pytest.mark.parametrize(
    "packages",
    [("reasoning",), pytest.param(OTHERS, marks=pytest.mark.slow)],
    ids=["reasoning", "others"],
)
def test_packages_for_own_robot_need_no_simulation(packages):
    """the rviz tools and maps use numpy as well"""
    if subprocess.run([sys.executable, "-c", "import rospy, rosoclingo.msg"], check=False, timeout=120).returncode:
        pytest.skip("there is no built workspace")
    fronts = [importlib.import_module(f"rosoclingo.{one}") for one in packages]
    names = [info.name for one in fronts for info in pkgutil.walk_packages(one.__path__, f"{one.__name__}.")]
    without_numpy = [name for name in names if not name.startswith(("rosoclingo.nodes.rviz.", "rosoclingo.runs.map_"))]
    for lacking, wanted in (("numba,llvmlite,PIL,scipy", names), ("numpy", without_numpy)):
        command = [sys.executable, "-c", WITHOUT, lacking, ",".join(wanted)]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
        assert done.returncode == 0, done.stderr
        lines = done.stdout.splitlines()
        if importlib.util.find_spec("tf2_ros") is None:  # compiled, and not for this Python
            lines = [line for line in lines if not line.endswith(" lacks tf2_ros")]
        assert not lines
