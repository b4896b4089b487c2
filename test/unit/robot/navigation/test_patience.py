"""The clock that measures patience."""

import pytest

from rosoclingo.robot.navigation import PatienceClock


@pytest.mark.parametrize(
    ("wall", "ros", "passed"),
    [
        (0.01, 0.1, 0.1),
        (0.1, 15.0, 2.0),  # a fast simulation
        (1.0, -30.0, -30.0),
    ],
)
def test_patience_clock_follows_ros_time_at_limited_speed(wall, ros, passed):
    now = [100.0]
    clock = PatienceClock(lambda: now[-1])
    clock.update(50.0)
    start = clock.now
    now.append(100.0 + wall)
    assert clock.update(50.0 + ros) == pytest.approx(start + passed)
