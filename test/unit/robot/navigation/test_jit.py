"""The folder of compiled code."""

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
