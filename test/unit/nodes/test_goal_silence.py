"""What a client makes of a server that says nothing of a goal."""

import pytest
from actionlib_msgs.msg import GoalStatusArray

from rosoclingo.nodes import server_watch
from rosoclingo.nodes.server_watch import SILENCE, UNHEARD, Beginning, Silence


class Clock:
    """Wall time and ROS time, as the test has them."""

    def __init__(self, monkeypatch):
        self.wall, self.ros = 100.0, 0.0
        monkeypatch.setattr(server_watch.time, "monotonic", lambda: self.wall)
        monkeypatch.setattr(server_watch.rospy, "get_time", lambda: self.ros)


@pytest.fixture
def clock(monkeypatch):
    return Clock(monkeypatch)


def turns(silence, clock, number, status=None):
    """Let turns pass, in each of which the server's status lacks the goal, if there is one."""
    for _ in range(number):
        if status is not None:
            silence.deny(status())
        clock.wall += SILENCE
        assert silence.turn()
        assert not silence.turn()


def test_a_goal_that_each_status_lacks_has_never_arrived(clock):
    silence = Silence()
    turns(silence, clock, UNHEARD - 1, GoalStatusArray)
    assert not silence.unheard
    turns(silence, clock, 1, GoalStatusArray)
    assert silence.unheard
    silence.end()
    assert not silence.unheard


def test_a_status_from_before_a_goal_was_sent_says_nothing_about_it(clock):
    """Where the simulated time stands still no other status may come."""
    before, silence = GoalStatusArray(), Silence()
    silence.end(before)
    turns(silence, clock, 2 * UNHEARD, lambda: before)
    assert not silence.unheard


def test_one_status_without_the_goal_and_then_none_says_nothing_about_it(clock):
    """It may have been on its way when the goal was sent, and then time stood still."""
    silence = Silence()
    silence.deny(GoalStatusArray())
    turns(silence, clock, 2 * UNHEARD)
    assert not silence.unheard


def test_time_that_has_not_begun_is_said_once_after_a_while(clock):
    beginning = Beginning()
    assert not beginning.line()
    clock.wall += server_watch.BEGINNING
    assert "ROS time has not begun" in beginning.line()
    assert not beginning.line()


def test_nothing_is_said_of_time_that_runs(clock):
    clock.ros, beginning = 1.0, Beginning()
    clock.wall += server_watch.BEGINNING
    assert not beginning.line()
