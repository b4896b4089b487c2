"""Gathering of messages that were sent together into one update."""

#: Limit in seconds of wall time that an update waits for queued arrivals.
GATHERING = 0.1

#: Seconds of wall time that an update with a new goal waits for further goals.
TOGETHER = 0.02


class Gathering:
    """Decides whether the next update waits; times are in seconds of a monotonic clock."""

    def __init__(self, now: float) -> None:
        self._since, self._goal_arrived = now, float("-inf")

    def goal_arrived(self, now: float) -> None:
        """Record the arrival of a goal, which others can follow."""
        self._goal_arrived = now

    def expects(self, now: float) -> bool:
        """Return whether further goals are expected, because a goal has just arrived."""
        return now - self._goal_arrived < TOGETHER

    def waits(self, now: float, queued: bool) -> bool:
        """Return whether the update waits, at most for GATHERING; ``queued`` is True if arrivals are queued."""
        waiting = queued or self.expects(now)
        if not waiting:
            self._since = now
        return waiting and now - self._since < GATHERING
