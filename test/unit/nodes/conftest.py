"""What the tests of nodes share."""

from pkgutil import extend_path

import pytest

import rosoclingo


@pytest.fixture
def messages(monkeypatch):
    """The package's messages; unit tests take it from its sources, where they are not."""
    pytest.importorskip("rosbag")
    monkeypatch.setattr(rosoclingo, "__path__", extend_path(list(rosoclingo.__path__), rosoclingo.__name__))
    return pytest.importorskip("rosoclingo.msg", reason="there is no built workspace")
