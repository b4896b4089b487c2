"""When the next update waits for arrivals that were sent together."""

#: Seconds of wall time for which an update waits for queued arrivals.
GATHERING = 0.1

#: Seconds of wall time for which an update with a new goal waits for others that were sent together with it.
TOGETHER = 0.02


class Gathering:
    """Decides whether the next update waits; times are in seconds of a monotonic clock."""

    def __init__(self, now: float) -> None:
        self._since, self._goal_came = now, float("-inf")

    def goal_came(self, now: float) -> None:
        """Note that a goal has come, which others can follow."""
        self._goal_came = now

    def expects(self, now: float) -> bool:
        """Return whether further goals are expected, as one has just come."""
        return now - self._goal_came < TOGETHER

    def waits(self, now: float, queued: bool) -> bool:
        """Return whether the update waits, for at most GATHERING; ``queued`` is whether arrivals are queued."""
        waiting = queued or self.expects(now)
        if not waiting:
            self._since = now
        return waiting and now - self._since < GATHERING
