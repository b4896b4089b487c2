"""Actions that may have been done: the server is asked, then the world."""

import pytest

from rosoclingo.interfaces.inquiry import RESULT_GRACE, Inquiry, InquiryResult, Listed

LIMIT = 5.0


def inquiry(*says):
    """An inquiry at time 10 that the world answers in these words, one after the other; without any nothing can."""
    words = iter(says)
    return Inquiry(lambda: next(words) if says else None, LIMIT, 10.0) if says else Inquiry(None, LIMIT, 10.0)


def test_a_goal_that_the_server_has_is_under_way_whatever_the_world_is_like():
    assert inquiry(True).look(Listed.HELD, 10.0) is InquiryResult.HELD


def test_the_server_is_waited_for():
    one = inquiry(True)
    assert one.look(None, 14.9) is InquiryResult.OPEN
    assert one.look(Listed.ABSENT, 14.95) is InquiryResult.DONE
    assert inquiry().look(None, 15.0) is InquiryResult.UNKNOWN


def test_the_world_is_asked_where_the_server_stays_away():
    assert inquiry(True).look(None, 15.0) is InquiryResult.DONE
    assert inquiry(False).look(None, 15.0) is InquiryResult.UNKNOWN, "a server out of reach may still do it"
    assert inquiry(None).look(None, 15.0) is InquiryResult.UNKNOWN


@pytest.mark.parametrize(("says", "finding"), [(True, InquiryResult.DONE), (False, InquiryResult.NOT_DONE)])
def test_the_world_is_waited_for(says, finding):
    one = inquiry(None, None, says)
    assert one.look(Listed.ABSENT, 10.0) is InquiryResult.OPEN
    assert one.look(Listed.ABSENT, 14.0) is InquiryResult.OPEN
    assert one.look(Listed.ABSENT, 16.0) is finding


def test_a_world_that_says_nothing_is_not_waited_for_too_long():
    one = inquiry(None, None)
    assert one.look(Listed.ABSENT, 14.0) is InquiryResult.OPEN
    assert one.look(Listed.ABSENT, 15.0) is InquiryResult.UNKNOWN


def test_where_nothing_can_tell_nothing_is_waited_for():
    assert inquiry().look(Listed.ABSENT, 10.0) is InquiryResult.UNKNOWN


def test_the_result_of_a_goal_that_has_ended_may_still_come():
    one = inquiry()
    assert one.look(Listed.ENDED, 11.0) is InquiryResult.OPEN
    assert one.look(Listed.HELD, 11.1) is InquiryResult.HELD
    assert one.look(Listed.ENDED, 11.0 + RESULT_GRACE) is InquiryResult.UNKNOWN


def test_a_goal_that_has_ended_makes_its_id_of_no_use():
    one = inquiry(False)
    one.look(Listed.ENDED, 10.0)
    assert one.used
    assert one.look(Listed.ABSENT, 10.1) is InquiryResult.NOT_DONE  # the server has forgotten it meanwhile
    assert not one.used
