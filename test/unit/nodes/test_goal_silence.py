"""What a client makes of a server that says nothing of a goal."""

from actionlib_msgs.msg import GoalStatusArray

from rosoclingo.nodes.server_watch import Silence


def test_a_status_from_before_a_goal_was_heard_of_says_nothing_about_it():
    """Where the simulated time stands still no other status may come."""
    silence, before, later = Silence(), GoalStatusArray(), GoalStatusArray()
    silence.deny(before)
    assert silence.denied
    silence.end(before)
    silence.deny(before)
    assert not silence.denied
    silence.deny(later)
    assert silence.denied
    silence.end()
    assert not silence.denied
