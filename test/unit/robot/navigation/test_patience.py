"""The clock that measures patience."""

import pytest

from rosoclingo.robot.navigation import PatienceClock


class Wall:
    now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def wall():
    return Wall()


def test_patience_clock_follows_ros_time_at_usual_speeds(wall):
    clock = PatienceClock(wall)
    clock.update(50.0)
    start = clock.now
    for i in range(1, 101):
        wall.now += 0.01
        assert clock.update(50.0 + 0.1 * i) == pytest.approx(start + 0.1 * i)


def test_patience_clock_is_slower_than_fast_simulation(wall):
    clock = PatienceClock(wall)
    clock.update(50.0)
    start = clock.now
    wall.now += 0.1
    assert clock.update(65.0) == pytest.approx(start + 2.0)
    wall.now += 1.0
    assert clock.update(75.0) == pytest.approx(start + 12.0)


def test_patience_clock_goes_back_with_ros_time(wall):
    clock = PatienceClock(wall)
    clock.update(50.0)
    before = clock.now
    wall.now += 1.0
    assert clock.update(20.0) == pytest.approx(before - 30.0)
