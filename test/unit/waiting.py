"""Waiting for a condition in wall time, as simulated time can stand still."""

import time

PATIENCE = 300.0  # seconds; long, so that no test depends on the speed or load of the machine


def wait_until(condition, what):
    """Return the first true value of a condition; the polling slows down."""
    end, pause = time.monotonic() + PATIENCE, 0.01
    while True:
        value = condition()
        if value:
            return value
        assert time.monotonic() < end, f"timed out: {what}"
        time.sleep(pause)
        pause = min(1.1 * pause, 0.05)
