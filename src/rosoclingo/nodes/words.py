"""The sentences of a core's program for its actions, and the interfaces that the core reports."""

import time
from contextlib import suppress

import rospy
from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import String

from rosoclingo.reasoning.interface_register import ReportedInterfaces
from rosoclingo.runs.recorded_run import RecordingError, RunProgram
from rosoclingo.runs.sentences import Sentences, sentences_of
from rosoclingo.runs.topic_names import full_name

#: Limit in seconds of wall time for the core's report, which it publishes once a second; seconds between two checks.
_REPORT, _TURN = 5.0, 0.02

#: Limit in seconds of wall time for the program of a running core, which publishes it at its start.
_WAIT = 10.0


def words_in(program: str) -> Sentences:
    """Return the sentences in a core's message ``~program``; none if the message is invalid."""
    with suppress(RecordingError):
        return sentences_of(RunProgram.parse(program))
    return Sentences()


def words_of(core: str) -> Sentences:
    """Return the sentences of a core's program; none if the core is not running or does not publish it in time."""
    topic = full_name("~program", core)
    if topic in (name for name, _ in rospy.get_published_topics()):
        with suppress(rospy.ROSException):
            return words_in(rospy.wait_for_message(topic, String, _WAIT).data)
    return Sentences()


def interfaces_of(core: str) -> ReportedInterfaces:
    """Return the interfaces that a core reports from now on; waits some seconds for its first report."""
    found, name = ReportedInterfaces(), core.strip("/") + ": core"

    def take(message: DiagnosticArray) -> None:
        """Process the status of the core."""
        for one in message.status:
            if one.name == name:
                values = {value.key: value.value for value in one.values}
                found.report(filter(None, values.get("interfaces", "").split(", ")), one.message)

    rospy.Subscriber("/diagnostics", DiagnosticArray, take)
    end = time.monotonic() + _REPORT
    while not found.known and time.monotonic() < end and not rospy.is_shutdown():
        time.sleep(_TURN)
    return found
