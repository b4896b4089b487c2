"""Fixtures that the tests of nodes share."""

from pkgutil import extend_path

import pytest

import rosoclingo


@pytest.fixture
def messages(monkeypatch):
    """The package's messages, where unit tests import the package from its sources, without messages."""
    pytest.importorskip("rosbag")
    monkeypatch.setattr(rosoclingo, "__path__", extend_path(list(rosoclingo.__path__), rosoclingo.__name__))
    return pytest.importorskip("rosoclingo.msg", reason="there is no built workspace")
