"""How the core is doing, in a few values: fed by its events."""

from enum import IntEnum
from typing import Dict, List, NamedTuple, Optional, Sequence

from rosoclingo.reasoning.events import PlanMade, Problem
from rosoclingo.reasoning.log_throttle import LogThrottle

#: Seconds for which a problem makes the core's state a warning.
FRESH = 10.0


class Level(IntEnum):
    """As ``diagnostic_msgs/DiagnosticStatus`` has them."""

    OK = 0
    WARN = 1


class Report(NamedTuple):
    """A level, a line, and values by name."""

    level: Level
    message: str
    values: Dict[str, str]


class Health:
    """Remembers the latest plan and the latest problem. ``now`` is in seconds of a clock that only goes forward."""

    def __init__(self) -> None:
        self._throttle = LogThrottle()
        self._plan: Optional[PlanMade] = None
        self._trouble = float("-inf")

    def plan_made(self, event: PlanMade) -> None:
        """There is an answer."""
        self._plan = event

    def problem(self, event: Problem, now: float) -> str:
        """Something is wrong; the line for the log, empty where it was said before."""
        self._trouble = now
        return self._throttle.take(event, now)

    def counted(self, now: float) -> List[str]:
        """Lines for the log: how many problems were not said, a minute after."""
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
        """The present state.

        ``awaited`` are the actions under way, ``interfaces`` those that were announced, ``missing`` tells of one that
        an action waits for in vain, ``waiting`` goals wait for their turn.
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
