"""The clock of time limits: ROS time, at most as fast as wall time, and never backwards."""

import pytest

from rosoclingo.common.paced_clock import PacedClock


def passed(*instants):
    clock = PacedClock()
    start = clock.at(*instants[0])
    return [clock.at(*instant) - start for instant in instants[1:]]


@pytest.mark.parametrize(
    ("instants", "expected"),
    [
        ([(5.0, 70.0), (6.0, 71.0), (8.0, 73.0)], [1.0, 3.0]),
        ([(5.0, 70.0), (15.0, 71.0), (605.0, 130.0)], [1.0, 60.0]),  # simulated time at ten times the speed
        ([(5.0, 70.0), (5.5, 71.0), (5.5, 90.0)], [0.5, 0.5]),  # slow, then stopped
        ([(500.0, 70.0), (3.0, 71.0), (4.0, 72.0)], [0.0, 1.0]),  # set back
        ([(5.0, 70.0), (10000.0, 70.1)], [0.1]),  # set forward
        ([(0.0, 70.0), (1700000000.0, 71.0), (1700000001.0, 72.0)], [1.0, 2.0]),  # the first /clock
    ],
)
def test_paced_clock_counts_the_expected_time(instants, expected):
    assert passed(*instants) == pytest.approx(expected)


def test_paced_clock_starts_at_the_first_reading():
    assert PacedClock().at(1700000000.0, 70.0) == 0.0
