"""A new package made from the templates; rostest new_package builds one and runs its test."""

import os
import re
from pathlib import Path

import pytest

from rosoclingo.nodes.new_package import NewPackageError, new_package

TEMPLATES = Path(__file__).resolve().parents[3] / "templates" / "package"


@pytest.fixture
def templates(tmp_path):
    folder = tmp_path / "templates"
    (folder / "@NAME@").mkdir(parents=True)
    (folder / "@NAME@" / "@NAME@.py").write_text("#!/usr/bin/env python3\nprint('@NAME@')\n", encoding="utf-8")
    (folder / "text").write_text("ä $(find @NAME@)/@NAME@\n", encoding="utf-8")
    return folder


def test_new_package_fills_the_templates(tmp_path):
    files = new_package("guard", tmp_path, TEMPLATES)
    assert {"CMakeLists.txt", "package.xml"} <= {path.name for path in files}
    assert not [path for path in files if "@" in str(path) or "@NAME@" in (tmp_path / path).read_text()]
    named = re.findall(r"^\| `([^`]+)`", (tmp_path / "guard" / "README.md").read_text(), re.MULTILINE)
    assert len(named) == 7
    assert not [name for name in named if not any(str(file).startswith(f"guard/{name}") for file in files)]
    for file in files:
        script = (tmp_path / file).read_text().startswith("#!")
        assert os.access(tmp_path / file, os.X_OK) == script, file


def test_new_package_refuses_a_name_in_use(templates, tmp_path):
    with pytest.raises(NewPackageError, match="the package std_msgs already exists"):
        new_package("std_msgs", tmp_path, templates, ["roscpp", "std_msgs"])
    assert not (tmp_path / "std_msgs").exists()
    (tmp_path / "mine").mkdir()
    with pytest.raises(NewPackageError, match="mine already exists"):
        new_package("mine", tmp_path, templates, ["mine"])


def test_new_package_refuses_a_folder_inside_a_package(templates, tmp_path):
    new_package("outer", tmp_path, TEMPLATES)
    with pytest.raises(NewPackageError, match="outer/config is inside a package, where ROS finds no other one"):
        new_package("inner", tmp_path / "outer" / "config", templates)


@pytest.mark.parametrize("name", ["Guard", "x", "../up", "x" * 101])
def test_new_package_refuses_an_invalid_name(name, templates, tmp_path):
    with pytest.raises(NewPackageError, match="use 2 to 100 lower-case letters, digits"):
        new_package(name, tmp_path / "folder", templates)


def test_new_package_removes_partial_output_after_failure(templates, tmp_path):
    with pytest.raises(NewPackageError, match="nowhere/guard: No such file or directory: choose another --folder"):
        new_package("guard", tmp_path / "nowhere", templates)
    (templates / ("@NAME@" + "x" * 245)).write_text("too long a name")
    with pytest.raises(NewPackageError, match="File name too long"):
        new_package("guard" * 5, tmp_path, templates)
    assert not (tmp_path / ("guard" * 5)).exists()
