"""The words that a core's program has for actions."""

from contextlib import suppress

import rospy
from std_msgs.msg import String

from rosoclingo.runs.recorded_run import RecordingError, RunProgram
from rosoclingo.runs.sentences import Sentences, sentences_of
from rosoclingo.runs.topic_names import full_name

#: Seconds of wall time to wait for the program; it is there as soon as the core is.
_WAIT = 2.0


def words_in(program: str) -> Sentences:
    """The words in what the core publishes as its program; what cannot be read has none."""
    with suppress(RecordingError):
        return sentences_of(RunProgram.parse(program))
    return Sentences()


def words_of(core: str) -> Sentences:
    """The words of the core of this name, none where it does not tell its program soon."""
    with suppress(rospy.ROSException):
        return words_in(rospy.wait_for_message(full_name("~program", core), String, _WAIT).data)
    return Sentences()
