"""The clock by which patience is measured."""

import pytest

from rosoclingo.robot.navigation import PatienceClock


class Wall:
    now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def wall():
    return Wall()


def test_it_goes_with_ros_time_at_usual_speeds(wall):
    clock = PatienceClock(wall)
    clock.update(50.0)
    start = clock.now
    for i in range(1, 101):
        wall.now += 0.01
        assert clock.update(50.0 + 0.1 * i) == pytest.approx(start + 0.1 * i)


def test_it_is_slower_than_a_simulation_that_rushes(wall):
    clock = PatienceClock(wall)
    clock.update(50.0)
    start = clock.now
    wall.now += 0.1
    assert clock.update(65.0) == pytest.approx(start + 2.0)
    wall.now += 1.0
    assert clock.update(75.0) == pytest.approx(start + 12.0)


def test_it_goes_back_when_time_does(wall):
    clock = PatienceClock(wall)
    clock.update(50.0)
    before = clock.now
    wall.now += 1.0
    assert clock.update(20.0) == pytest.approx(before - 30.0)
