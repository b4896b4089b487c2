"""Inquiries about actions that have perhaps been executed: the server is asked first, then the world."""

import pytest

from rosoclingo.interfaces.inquiry import RESULT_GRACE, Inquiry, InquiryResult, ServerReport

LIMIT = 5.0


def inquiry(*says):
    """Return an inquiry at time 10, which the world answers in turn with these words; without words it cannot tell."""
    words = iter(says)
    return Inquiry(lambda: next(words) if says else None, LIMIT, 10.0) if says else Inquiry(None, LIMIT, 10.0)


def test_inquiry_goal_known_to_server_is_under_way():
    assert inquiry(True).look(ServerReport.HELD, 10.0) is InquiryResult.HELD


def test_inquiry_waits_for_the_server():
    one = inquiry(True)
    assert one.look(None, 14.9) is InquiryResult.OPEN
    assert one.look(ServerReport.ABSENT, 14.95) is InquiryResult.DONE
    assert inquiry().look(None, 15.0) is InquiryResult.UNKNOWN


def test_inquiry_asks_world_if_server_is_absent():
    assert inquiry(True).look(None, 15.0) is InquiryResult.DONE
    assert inquiry(False).look(None, 15.0) is InquiryResult.UNKNOWN, "an unreachable server can still execute it"
    assert inquiry(None).look(None, 15.0) is InquiryResult.UNKNOWN


@pytest.mark.parametrize(("says", "finding"), [(True, InquiryResult.DONE), (False, InquiryResult.NOT_DONE)])
def test_inquiry_waits_for_the_world(says, finding):
    one = inquiry(None, None, says)
    assert one.look(ServerReport.ABSENT, 10.0) is InquiryResult.OPEN
    assert one.look(ServerReport.ABSENT, 14.0) is InquiryResult.OPEN
    assert one.look(ServerReport.ABSENT, 16.0) is finding


def test_inquiry_waits_limited_time_for_silent_world():
    one = inquiry(None, None)
    assert one.look(ServerReport.ABSENT, 14.0) is InquiryResult.OPEN
    assert one.look(ServerReport.ABSENT, 15.0) is InquiryResult.UNKNOWN


def test_inquiry_without_any_source_does_not_wait():
    assert inquiry().look(ServerReport.ABSENT, 10.0) is InquiryResult.UNKNOWN


def test_inquiry_accepts_late_result_of_ended_goal():
    one = inquiry()
    assert one.look(ServerReport.ENDED, 11.0) is InquiryResult.OPEN
    assert one.look(ServerReport.HELD, 11.1) is InquiryResult.HELD
    assert one.look(ServerReport.ENDED, 11.0 + RESULT_GRACE) is InquiryResult.UNKNOWN


def test_inquiry_does_not_reuse_id_of_ended_goal():
    one = inquiry(False)
    one.look(ServerReport.ENDED, 10.0)
    assert one.used
    assert one.look(ServerReport.ABSENT, 10.1) is InquiryResult.NOT_DONE  # the server has forgotten it meanwhile
    assert not one.used
