"""The folder of compiled code."""

import os
import subprocess
import sys

import pytest

from rosoclingo.robot.navigation.compiled.jit import cache_folder


@pytest.fixture
def sources(tmp_path):
    for name in ("a/compiled/one.py", "b/compiled/more.py", "b/other.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("x = 1\n")
    return tmp_path


def test_jit_folder_changes_with_any_compiled_file(sources):
    """Functions of one file can be compiled into those of other files."""
    before = cache_folder(sources)
    (sources / "b" / "other.py").write_text("x = 2\n")
    assert cache_folder(sources) == before
    (sources / "b" / "compiled" / "more.py").write_text("x = 2\n")
    assert cache_folder(sources) != before


@pytest.mark.slow
def test_jit_unwritable_folder_costs_only_time(tmp_path):
    (tmp_path / "file").write_text("")
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "file" / "folder")}
    code = (
        "import numpy as np; from rosoclingo.robot.navigation.compiled.clearance import square_distance as f; "
        "print(f(np.zeros((3, 3), dtype=np.uint8), 1.0, 1.0, 2.0))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, stdout=subprocess.PIPE, check=True, timeout=120
    )
    assert done.stdout.decode().strip() == "2.0"
