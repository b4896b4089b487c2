"""Deferral: withdraw goals from the program, unless actions were executed for them."""

from typing import Any, Callable, List, Optional, Sequence, Tuple

from rosoclingo.oclingo import SolveOutcome, SolverError, Statement, StreamUpdate
from rosoclingo.oclingo.progression.updates import Withdraw
from rosoclingo.reasoning.goal_manager import GoalManager
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import requests_of
from rosoclingo.reasoning.keywords import Action, cancellation, success_of
from rosoclingo.reasoning.stream_planner import Planner


def defer(
    planner: Planner,
    manager: GoalManager,
    chosen: Sequence[Goal],
    why: str,
    published: int,
    executed: Sequence[Action],
    look: Callable[[], Any],
) -> Tuple[Planner, str]:
    """Queue the ``chosen`` goals that are not in hand, or other goals if all of them are; ``why`` is the reason.

    A goal is in hand if an action was executed for it. No action was executed for goals that arrived after the last of
    the ``executed`` actions. Cancelled goals among these end instead. For older goals, a search decides; it ends when
    ``look()`` is not None. ``published`` is the cycle of the last reported update.

    Returns the planner without the goals, and a text about them. Raises DisturbedError, with nothing changed.
    """
    first = max([planner.log.keep_from, *(action.cycle + 1 for action in executed)])
    fed = manager.fed
    fresh = [goal for goal in fed if (goal.request_cycle or 0) > first]
    cancelled = [goal for goal in fresh if goal.cancelling]
    if cancelled:
        planner = planner.restarted(requests_of(cancelled))
        manager.take_out(cancelled, published)
        return planner, f"{why}: {len(cancelled)} of {len(fed)} goals are withdrawn because they were cancelled"
    others = [goal for goal in fed if goal not in chosen and not goal.cancelling] if chosen else []
    for goals in (chosen, others):
        old = [
            one for one in goals if one.fed and one not in fresh and (one.request_cycle or 0) > planner.log.keep_from
        ]
        free = _withdrawable(planner, old, fed, fresh, executed, look) if old else []
        gone = [one for one in goals if not one.fed or one in fresh or one in free]
        if gone:
            planner = planner.restarted(requests_of(gone))
            number = len({*fed, *gone})
            manager.defer(gone, f"{number} goals were too many: {why}", published)
            return planner, f"{why}: {len(gone)} of {number} goals wait"
    manager.queue.keep(chosen)
    return planner, f"{why}: the search goes on"


def _withdrawable(
    planner: Planner,
    goals: Sequence[Goal],
    fed: Sequence[Goal],
    fresh: Sequence[Goal],
    executed: Sequence[Action],
    look: Callable[[], Any],
) -> List[Goal]:
    """Return those of the ``goals`` that are not in hand.

    A goal is not in hand if withdrawing it is equivalent to cancelling it. This is tested with all other goals
    cancelled: both ways must have plans of the same length. For example, a package that was picked up for a goal has to
    be brought back when the goal is cancelled. Without the request, it could never have been picked up. The trial
    retracts success returns, because a program can derive from them that an action was possible.
    """
    step = planner.log.step + 1
    successes = frozenset(success_of(action) for action in executed if action.cycle > planner.log.keep_from)

    def plan(withdrawn: Sequence[Goal], limit: int) -> Optional[int]:
        """Return the steps of a plan with some goals withdrawn and the others cancelled; None if none was found."""
        gone = requests_of([*fresh, *withdrawn])
        cancelled = [one for one in fed if one not in fresh and one not in withdrawn]
        cancels = (Statement(cancellation(one.identifier, step)) for one in cancelled)
        trial = planner.restarted(gone | successes)
        trial.lookahead = limit
        try:
            result = trial.update(StreamUpdate(step, items=(*map(Withdraw, sorted(gone)), *cancels)))
        except SolverError:
            return None
        return result.horizon - step if result.outcome is SolveOutcome.SATISFIABLE else None

    steps = plan((), planner.lookahead)
    found: List[Goal] = []
    parts = [list(goals)]
    while steps is not None and parts and look() is None:
        part = parts.pop(0)
        half = len(part) // 2
        if plan([*found, *part], steps) is not None:
            found += part
        elif half:
            parts[:0] = [part[:half], part[half:]]
    return found
