"""Messages of the demonstration about a system that has ended by itself."""

import os
from importlib import import_module
from unittest.mock import patch

import pytest

LINES = ["summary"] * 20
KILLED = ["[one] killing on exit"] * 30


@pytest.fixture
def demo(messages):
    """The module, with the built messages."""
    return import_module("rosoclingo.nodes.demo")


@pytest.mark.parametrize(
    ("log", "shown"),
    [
        ([*LINES, "[FATAL] [1.0]: /rosoclingo: a fault", "and another", *KILLED], ["/rosoclingo: a fault", "another"]),
        ([*LINES, "RLException: no such file"], ["RLException: no such file"]),
        (["one line"], ["one line"]),
    ],
    ids=["fatal", "last", "short"],
)
def test_demo_shows_the_error_despite_later_output(demo, tmp_path, log, shown):
    (tmp_path / "log").write_text("\n".join(log))
    roslaunch = tmp_path / "roslaunch"
    roslaunch.write_text(f"#!/bin/sh\ncat {tmp_path}/log\n")
    roslaunch.chmod(0o755)
    system = demo.DemoSystem("mailbot", tmp_path / "run", [])
    path = f"{tmp_path}:{os.environ['PATH']}"
    with patch.dict(os.environ, PATH=path), pytest.raises(demo.DemoError) as caught:  # also undoes the system's changes
        system.__enter__()
    reported = str(caught.value)
    assert str(system.log) in reported
    assert all(words in reported for words in shown)
    assert reported.count("\n") <= 15
