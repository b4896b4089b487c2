"""Messages of the demonstration about a system that has ended by itself."""

import subprocess
from importlib import import_module

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
    system = demo.DemoSystem("mailbot", tmp_path, [])
    system.log.write_text("\n".join(log))
    system._process = subprocess.Popen(["true"])
    system._process.wait()
    with pytest.raises(demo.DemoError) as caught:
        system.check()
    reported = str(caught.value)
    assert str(system.log) in reported
    assert all(words in reported for words in shown)
    assert reported.count("\n") <= 15
