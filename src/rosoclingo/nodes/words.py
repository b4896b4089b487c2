"""The words that a core's program has for actions."""

from contextlib import suppress

import rospy
from std_msgs.msg import String

from rosoclingo.runs.recorded_run import RecordingError, RunProgram
from rosoclingo.runs.sentences import Sentences, sentences_of
from rosoclingo.runs.topic_names import full_name

#: Seconds of wall time to wait for the program where there is a core: it tells it as it starts.
_WAIT = 10.0


def words_in(program: str) -> Sentences:
    """The words in what the core publishes as its program; what cannot be read has none."""
    with suppress(RecordingError):
        return sentences_of(RunProgram.parse(program))
    return Sentences()


def words_of(core: str) -> Sentences:
    """The words of the core of this name, none where it is not there or does not tell its program soon."""
    topic = full_name("~program", core)
    if topic in (name for name, _ in rospy.get_published_topics()):
        with suppress(rospy.ROSException):
            return words_in(rospy.wait_for_message(topic, String, _WAIT).data)
    return Sentences()
