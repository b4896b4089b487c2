"""Inquiries about actions that have perhaps been executed: the server is asked first, then the world."""

import pytest

from rosoclingo.interfaces.inquiry import RESULT_GRACE, Inquiry, InquiryResult, ServerReport

LIMIT = 5.0


def inquiry(*says):
    """Return an inquiry at time 10, which the world answers in turn with these words; without words it cannot tell."""
    words = iter(says)
    return Inquiry(lambda: next(words) if says else None, LIMIT, 10.0) if says else Inquiry(None, LIMIT, 10.0)


HELD, ENDED, ABSENT = ServerReport.HELD, ServerReport.ENDED, ServerReport.ABSENT


@pytest.mark.parametrize(
    ("says", "looks"),
    [
        # the server is asked first
        ([True], [(HELD, 10.0, "HELD")]),
        ([True], [(None, 14.9, "OPEN"), (ABSENT, 14.95, "DONE")]),
        ([], [(None, 15.0, "UNKNOWN")]),
        # then the world; an unreachable server can still execute the action
        ([True], [(None, 15.0, "DONE")]),
        ([False], [(None, 15.0, "UNKNOWN")]),
        ([None], [(None, 15.0, "UNKNOWN")]),
        # the world can take some time
        ([None, None, True], [(ABSENT, 10.0, "OPEN"), (ABSENT, 14.0, "OPEN"), (ABSENT, 16.0, "DONE")]),
        ([None, None, False], [(ABSENT, 10.0, "OPEN"), (ABSENT, 14.0, "OPEN"), (ABSENT, 16.0, "NOT_DONE")]),
        ([None, None], [(ABSENT, 14.0, "OPEN"), (ABSENT, 15.0, "UNKNOWN")]),
        ([], [(ABSENT, 10.0, "UNKNOWN")]),
        # the result of a goal that has ended can be late
        ([], [(ENDED, 11.0, "OPEN"), (HELD, 11.1, "HELD"), (ENDED, 11.0 + RESULT_GRACE, "UNKNOWN")]),
    ],
)
def test_inquiry_asks_the_server_and_then_the_world(says, looks):
    one = inquiry(*says)
    for report, time, result in looks:
        assert one.look(report, time) is InquiryResult[result]


def test_inquiry_does_not_reuse_id_of_ended_goal():
    one = inquiry(False)
    one.look(ServerReport.ENDED, 10.0)
    assert one.used
    assert one.look(ServerReport.ABSENT, 10.1) is InquiryResult.NOT_DONE  # the server has forgotten it meanwhile
    assert not one.used
