"""Collisions that are detected from the robot's standstill, as Stage reports them."""

import pytest
from stalls import Stalls


def drive(*parts):
    """Return the samples of parts (steps of 0.1 s, commanded speed or None, true speed)."""
    stalls, x, now = Stalls(), 0.0, 0.0
    for steps, wanted, true in parts:
        for _ in range(steps):
            if wanted is not None:
                stalls.command(now, wanted, 0.0)
            now, x = now + 0.1, x + 0.1 * true
            stalls.truth(now, x, 0.0, 0.0)
    return stalls.times


@pytest.mark.parametrize(
    ("parts", "times"),
    [
        ([(20, 0.5, 0.5)], 0),
        ([(20, 0.0, 0.0)], 0),
        ([(5, 0.5, 0.5), (20, 0.5, 0.0)], 1),
        ([(5, 0.5, 0.5), (5, 0.5, 0.0), (5, -0.5, -0.5), (5, 0.5, 0.5), (5, 0.5, 0.0)], 2),
        ([(5, 0.5, 0.5), (20, None, 0.0)], 0),  # no command: the watchdog stops it
        ([(5, 0.0, 0.0), (2, 0.5, 0.0), (5, 0.5, 0.4)], 0),  # it accelerates
    ],
)
def test_stalls_are_detected(parts, times):
    assert drive(*parts) == times


def test_stall_of_robot_that_cannot_turn():
    stalls = Stalls()
    for step in range(10):
        stalls.command(0.1 * step, 0.0, 0.5)
        stalls.truth(0.1 * step + 0.1, 1.0, 1.0, 0.3)
    assert stalls.times == 1
