"""The compile rehearsals: complete, without a function compiled twice, reported once, cached."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from rosoclingo.robot.nodes import compiling

HERE = Path(__file__).resolve().parents[2]
SOURCES = Path(compiling.__file__).parents[3]  # along the same path as here, which the cache is for
# Other tests call functions in ways that no robot does, so this runs in a process of its own.
DRIVES = """
import importlib, pkgutil, sys
from navigation_worlds import LONG, Drive, room, simulation
from rosoclingo.robot.navigation import Pose2D
from rosoclingo.robot.nodes.compiling import PARTS
from rosoclingo.robot.simulation import Box, DoorSpec, ObstacleSpec

functions = []
for part in PARTS:
    package = importlib.import_module(f"rosoclingo.robot.{part}.compiled")
    for one in pkgutil.iter_modules(package.__path__, package.__name__ + "."):
        assert one.name in sys.modules, f"{one.name} is not rehearsed"
        functions += [f for f in vars(sys.modules[one.name]).values() if hasattr(f, "signatures")]

def compiled():
    return {(one.py_func.__module__, one.__name__): one.signatures for one in functions}

for rehearse in PARTS.values():
    rehearse()
before = compiled()
for name, signatures in before.items():
    assert len(signatures) <= 1, (name, signatures)  # none where a compiled caller was kept that has it inside
things = (ObstacleSpec("box", (2.0, 1.0), box=Box(0.3, 0.3)), ObstacleSpec("post", (4.5, 1.0), radius=0.1))
door = DoorSpec("door", (3.0, 0.0), (3.0, 2.0), open=False)
walls = [(2.9, 2.0, 3.1, 3.5), (2.9, 4.05, 3.1, 5.2)]
for footprint in ((), LONG):
    drive = Drive(simulation(room(walls=walls), Pose2D(1.0, 1.0), (door,), things, footprint=footprint))
    drive.to(Pose2D(5.0, 1.0, 2.0))
    drive.to(Pose2D(3.0, 3.77, 0.0))
    drive.to(Pose2D(5.7, 5.7, 0.0))
    drive.costmap.costs(Pose2D(1.0, 1.0, 0.5), (20, 20))
    drive.world.place(drive.robot.spec.name, Pose2D(1.0, 1.0))
after = compiled()
assert after == before, {name: after[name] for name in after if after[name] != before[name]}
print(len(after))
"""


def run(code, *arguments, **environment):
    path = os.pathsep.join([str(HERE), str(SOURCES), *sys.path])
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env={**os.environ, "PYTHONPATH": path, **environment},
        stdout=subprocess.PIPE,
        check=True,
    ).stdout.decode()


@pytest.mark.slow
def test_rehearsal_leaves_nothing_to_compile():
    assert int(run(DRIVES)) > 40


@pytest.fixture
def folder(monkeypatch, tmp_path):
    monkeypatch.setattr(compiling, "FOLDER", str(tmp_path))
    return tmp_path


def test_rehearsal_is_reported_once(folder):
    said = []
    compiling.compile_once("simulation", said.append)
    (line,) = said
    assert line.startswith("compiling simulation once")
    assert str(folder) in line
    compiling.compile_once("simulation", said.append)
    assert len(said) == 1


def test_rehearsal_compiles_without_a_folder(monkeypatch, tmp_path):
    monkeypatch.setattr(compiling, "FOLDER", str(tmp_path / "no" / "where"))
    said = []
    compiling.compile_once("simulation", said.append)
    assert said


@pytest.mark.slow
def test_rehearsal_of_build_provides_cache_for_nodes(tmp_path):
    """A node without a cache takes over the one in the share folder of the workspace."""
    share = tmp_path / "space" / "share" / "rosoclingo" / "numba"
    run("from rosoclingo.robot.nodes.compiling import main; main()", str(share))
    code = "from rosoclingo.robot.nodes import compiling as c; [c.compile_once(part, print) for part in c.PARTS]"
    new = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "CMAKE_PREFIX_PATH": f"/nowhere:{tmp_path / 'space'}"}
    assert run(code, **new) == ""
    (kept,) = (tmp_path / "cache").iterdir()
    assert sorted(path.name for path in kept.iterdir()) == sorted(path.name for path in next(share.iterdir()).iterdir())
