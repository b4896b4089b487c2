"""The health of the core, for ``/diagnostics``."""

from typing import Dict, List, Optional, Sequence, Tuple

from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import Mode, PlanMade, Problem
from rosoclingo.reasoning.log_throttle import LogThrottle

#: Seconds for which a problem sets the level to WARN.
FRESH = 10.0

#: Levels of ``diagnostic_msgs/DiagnosticStatus``.
OK, WARN = 0, 1


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

    def describe(
        self, core: Core, now: float, interfaces: Sequence[str], fault: str = ""
    ) -> Tuple[int, str, Dict[str, object]]:
        """Return a level, a message of one line, and values by name.

        ``interfaces`` are the announced ones. ``fault`` is a message that is more urgent than the core's own, empty for
        none.
        """
        plan, goals = self._plan or PlanMade(core.cycle, 1, ()), core.live_goals
        awaited, lost = ", ".join(str(one.atom) for one in core.awaited), sorted(core.interfaces.lost)
        values = {
            "cycle": core.cycle,
            "horizon": plan.horizon,
            "open goals": len(goals),
            "waiting goals": sum(not goal.fed for goal in goals),
            "awaited actions": awaited,
            "interfaces": ", ".join(interfaces),
            "last solve time": f"{plan.solve:.3f}",
            "last ground time": f"{plan.ground:.3f}",
            "problems": self._throttle.count,
            "last error": self._throttle.latest,
            "mode": core.mode.value,
        }
        trouble = self._throttle.latest if now - self._trouble < FRESH else ""
        warning = f"lost robots: {', '.join(map(str, lost))}" if lost else trouble
        message = warning or (f"waits for {awaited}" if awaited else "idle")
        if core.mode is not Mode.RUNNING:
            warning = message = f"{core.mode.value}: {message}"
        return WARN if fault or warning else OK, fault or message, values
