"""The packages' fronts: every name is there, and who wants little does not load the compiler."""

import importlib
import subprocess
import sys
from pathlib import Path

import pytest

SOURCES = Path(__file__).resolve().parents[2] / "src"


@pytest.mark.parametrize("package", ["rosoclingo.robot.navigation", "rosoclingo.robot.simulation"])
def test_every_name_is_there(package):
    module = importlib.import_module(package)
    for name in module.__all__:
        assert getattr(module, name).__name__ == name or not hasattr(getattr(module, name), "__name__")
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        module.nonsense  # noqa: B018


@pytest.mark.parametrize(
    "module", ["rosoclingo.robot.simulation.office_packages", "rosoclingo.robot.navigation.geometry"]
)
def test_what_needs_no_compiler_loads_none(module):
    code = f"import sys, {module}; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=str(SOURCES), check=False, timeout=120).returncode == 0
