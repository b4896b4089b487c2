"""How long the next update waits for messages that were sent together."""

import pytest

from rosoclingo.nodes.core.gathering import GATHERING, TOGETHER, Gathering


def test_update_waits_for_goals_that_were_sent_together():
    gathering, now = Gathering(100.0), 100.0
    assert not gathering.waits(now, False)
    for _ in range(3):
        gathering.goal_arrived(now)
        assert gathering.waits(now, False)
        now += 0.9 * TOGETHER
        assert gathering.waits(now, False)
    assert not gathering.waits(now + TOGETHER, False)


@pytest.mark.parametrize("queued", [True, False])
def test_update_waits_limited_time_for_endless_arrivals(queued):
    gathering, step = Gathering(100.0), 0.5 * TOGETHER
    times = [100.0 + step * number for number in range(100)]
    waits = [gathering.goal_arrived(now) or gathering.waits(now, queued) for now in times]
    assert waits.index(False) == pytest.approx(GATHERING / step, abs=1)
    assert not any(waits[waits.index(False) :]), "arrivals that go on do not stop the robot"
