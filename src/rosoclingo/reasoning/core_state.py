"""The health of the core, for ``/diagnostics``."""

from enum import IntEnum
from typing import Dict, List, NamedTuple, Optional, Sequence

from rosoclingo.reasoning.events import PlanMade, Problem
from rosoclingo.reasoning.log_throttle import LogThrottle

#: Seconds for which a problem sets the level to WARN.
FRESH = 10.0


class Level(IntEnum):
    """The levels of ``diagnostic_msgs/DiagnosticStatus``."""

    OK = 0
    WARN = 1


class Report(NamedTuple):
    """A level, a message of one line, and values by name."""

    level: Level
    message: str
    values: Dict[str, str]


class Health:
    """Keeps the latest plan and the latest problem. ``now`` is in seconds of a monotonic clock."""

    def __init__(self) -> None:
        self._throttle = LogThrottle()
        self._plan: Optional[PlanMade] = None
        self._trouble = float("-inf")

    def plan_made(self, event: PlanMade) -> None:
        """Record the latest plan."""
        self._plan = event

    def problem(self, event: Problem, now: float) -> str:
        """Record a problem; return the line for the log, empty if it was logged before."""
        self._trouble = now
        return self._throttle.take(event, now)

    def counted(self, now: float) -> List[str]:
        """Return log lines with the number of problems that were not logged in the last minute."""
        return self._throttle.counted(now)

    def report(
        self,
        cycle: int,
        goals: int,
        awaited: Sequence[str],
        now: float,
        interfaces: Sequence[str] = (),
        missing: str = "",
        waiting: int = 0,
    ) -> Report:
        """Return the present state.

        ``awaited`` are the running actions, ``interfaces`` the announced interfaces. ``missing`` is a message about an
        interface that an action needs but no node has, empty for none. ``waiting`` is the number of queued goals.
        """
        plan = self._plan or PlanMade(cycle, 1, ())
        values = {
            "cycle": cycle,
            "horizon": plan.horizon,
            "open goals": goals,
            "waiting goals": waiting,
            "awaited actions": ", ".join(awaited),
            "interfaces": ", ".join(interfaces),
            "last solve time": f"{plan.solve:.3f}",
            "last ground time": f"{plan.ground:.3f}",
            "problems": self._throttle.count,
            "last error": self._throttle.latest,
        }
        level, message = Level.OK, "waits for {}".format(", ".join(awaited)) if awaited else "idle"
        if missing:
            level, message = Level.WARN, missing
        elif now - self._trouble < FRESH:
            level, message = Level.WARN, self._throttle.latest
        return Report(level, message, {key: str(value) for key, value in values.items()})
