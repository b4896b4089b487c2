"""The compile rehearsals: complete, without a function compiled twice, reported once."""

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
    drive.costmap.costs_around(Pose2D(1.0, 1.0, 0.5), (20, 20))
    drive.world.place(drive.robot.spec.name, Pose2D(1.0, 1.0))
after = compiled()
assert after == before, {name: after[name] for name in after if after[name] != before[name]}
print(len(after))
"""


@pytest.mark.slow
def test_rehearsal_leaves_nothing_to_compile():
    path = os.pathsep.join([str(HERE), str(SOURCES), *sys.path])
    done = subprocess.run(
        [sys.executable, "-c", DRIVES], env={**os.environ, "PYTHONPATH": path}, stdout=subprocess.PIPE, check=True
    )
    assert int(done.stdout) > 40


def test_rehearsal_is_reported_once(monkeypatch, tmp_path):
    """Without a writable folder it is reported each time."""
    for folder, times in (("", 1), ("no/where", 2)):
        said = []
        monkeypatch.setattr(compiling, "FOLDER", str(tmp_path / folder))
        for _ in range(2):
            compiling.compile_once("simulation", said.append)
        assert [one.startswith("compiling simulation once") for one in said] == [True] * times
