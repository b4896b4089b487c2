"""Messages while ROS time has not begun."""

import pytest

from rosoclingo.nodes import server_watch
from rosoclingo.nodes.server_watch import Beginning


class Clock:
    """Wall time and ROS time, set by the test."""

    def __init__(self, monkeypatch):
        self.wall, self.ros = 100.0, 0.0
        monkeypatch.setattr(server_watch.time, "monotonic", lambda: self.wall)
        monkeypatch.setattr(server_watch.rospy, "get_time", lambda: self.ros)


@pytest.fixture
def clock(monkeypatch):
    return Clock(monkeypatch)


def test_server_watch_reports_missing_clock_once_after_delay(clock):
    beginning = Beginning()
    assert not beginning.line()
    clock.wall += server_watch.BEGINNING
    assert "ROS time has not begun" in beginning.line()
    assert not beginning.line()


def test_server_watch_is_silent_while_time_runs(clock):
    clock.ros, beginning = 1.0, Beginning()
    clock.wall += server_watch.BEGINNING
    assert not beginning.line()
