"""The health of the core, for ``/diagnostics``."""

from typing import Dict, Optional, Sequence, Tuple

from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import Mode, PlanMade
from rosoclingo.reasoning.log_throttle import LogThrottle

#: Seconds for which a problem sets the level to WARN.
FRESH = 10.0

#: Levels of ``diagnostic_msgs/DiagnosticStatus``.
OK, WARN = 0, 1


def describe_core(
    core: Core, plan: Optional[PlanMade], problems: LogThrottle, interfaces: Sequence[str], fault: str, now: float
) -> Tuple[int, str, Dict[str, object]]:
    """Return the level of a core, a message of one line, and values by name.

    ``plan`` is the latest one, ``interfaces`` are the announced ones. ``fault`` is a message that is more urgent than
    the core's own, empty for none. ``now`` is in seconds of the clock of ``problems``.
    """
    plan, goals = plan or PlanMade(core.cycle, 1, ()), core.live_goals
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
        "problems": problems.count,
        "last error": problems.latest,
        "mode": core.mode.value,
    }
    trouble = problems.latest if now - problems.time < FRESH else ""
    warning = f"lost robots: {', '.join(map(str, lost))}" if lost else trouble
    message = warning or (f"waits for {awaited}" if awaited else "idle")
    if core.mode is not Mode.RUNNING:
        warning = message = f"{core.mode.value}: {message}"
    return WARN if fault or warning else OK, fault or message, values
