"""The search for cheaper plans of equal length, for programs with ``#minimize``."""

from typing import Generator, Optional

from rosoclingo.planning.question import Assumptions, Question, Reply, Stop
from rosoclingo.planning.strategy_runner import StrategyRunner

CONFLICTS = 1000
"""Limit of conflicts for computing the cost of a plan; most plans need few."""


def cheaper(
    found: Reply,
    runner: StrategyRunner,
    step: int,
    given: Assumptions,
    conflicts: Optional[int],
    until: Optional[Stop] = None,
) -> Generator[Question, Reply, Reply]:
    """Return the best answer with the horizon of ``found`` and the assumptions ``given``.

    If the search ends without a better answer, the result is ``found`` with its cost. The cost is computed if ``found``
    has none: it is the least cost of all answers with the same actions from ``step`` on.
    """
    last = found.horizon
    if not found.cost:
        fixed = found.plan.fixing(runner.actions(step, last))
        reply = yield Question(last, last, fixed, conflicts=CONFLICTS, best=True, proven=False, until=until)
        if not reply.satisfiable:
            return found
        found = reply._replace(optimal=False)
    reply = yield Question(last, last, given, conflicts=conflicts, best=True, proven=False, until=until)
    if not reply.satisfiable or reply.cost > found.cost:
        return found
    return reply if reply.cost < found.cost else found._replace(optimal=reply.optimal)
