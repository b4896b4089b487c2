"""The sentences of a core's program for its actions."""

from contextlib import suppress

import rospy
from std_msgs.msg import String

from rosoclingo.runs.recorded_run import RecordingError, RunProgram
from rosoclingo.runs.sentences import Sentences, sentences_of
from rosoclingo.runs.topic_names import full_name

#: Limit in seconds of wall time for the program of a running core, which publishes it at its start.
_WAIT = 10.0


def words_of(core: str) -> Sentences:
    """Return the sentences of a core's program; none if the core is not running or does not publish it in time."""
    topic = full_name("~program", core)
    if topic in (name for name, _ in rospy.get_published_topics()):
        with suppress(rospy.ROSException, RecordingError):
            return sentences_of(RunProgram.parse(rospy.wait_for_message(topic, String, _WAIT).data))
    return Sentences()
