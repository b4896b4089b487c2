"""What to give up when the solver finds no plan: as few goals as possible, the newest first.

Goals are given up in the next update, by the program's own means, ``_request(cancel(Id),C)``; so the stream that was
sent stays a true record. The search for them is done on fresh solvers beside the stream.
"""

from typing import FrozenSet, List, NamedTuple, Optional, Sequence, Tuple

from clingo import Symbol

from rosoclingo.oclingo import SolveOutcome, SolverError, SolveResult, Statement, StreamUpdate
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.keywords import cancellation, request
from rosoclingo.reasoning.planner import Planner


class Recovery(NamedTuple):
    """A way on: ``update`` starts the next cycle on ``planner`` with ``result``, without the ``dropped`` goals.

    ``forgotten`` tells that cancelling did not help, so that the requests had to be taken out of the history.
    """

    planner: Planner
    update: StreamUpdate
    result: SolveResult
    dropped: Tuple[Goal, ...]
    forgotten: bool = False

    @property
    def met(self) -> bool:
        """Whether there is a plan for the goals that are kept."""
        return self.result.outcome is SolveOutcome.SATISFIABLE


def recover(planner: Planner, step: int, goals: Sequence[Goal], suspects: Sequence[Goal]) -> Optional[Recovery]:
    """Find the goals to drop at ``step``, out of the live ``goals`` that were fed, oldest first.

    First the ``suspects`` go, then all goals; of these, every goal is kept that can be met with the ones kept before
    it, until a search takes so long that it is interrupted. None when there is no plan even without any goal.
    """
    for dropped in _distinct(suspects, goals):
        found = _attempt(planner, step, dropped)
        if found.met:
            return _keep_what_can_be_met(planner, step, found)
    found = _attempt(planner, step, tuple(goals), forgotten=True)
    return found if found.met else None


def _distinct(suspects: Sequence[Goal], goals: Sequence[Goal]) -> List[Tuple[Goal, ...]]:
    sets = [tuple(suspects)] if suspects else []
    return sets if len(suspects) == len(goals) else [*sets, tuple(goals)]


def _keep_what_can_be_met(planner: Planner, step: int, found: Recovery) -> Recovery:
    for goal in found.dropped:
        fewer = tuple(other for other in found.dropped if other is not goal)
        if fewer:
            tried = _attempt(planner, step, fewer)
            if tried.result.outcome is SolveOutcome.INTERRUPTED:
                return found
            found = tried if tried.met else found
    return found


def _attempt(planner: Planner, step: int, dropped: Tuple[Goal, ...], forgotten: bool = False) -> Recovery:
    cancels = () if forgotten else tuple(Statement(cancellation(goal.identifier, step)) for goal in dropped)
    update = StreamUpdate(step=step, items=cancels)
    try:
        fresh = planner.restarted(requests_of(dropped) if forgotten else frozenset())
        fresh.end_cycle(step - 1, ())
        result = fresh.update(update)
    except SolverError:  # what is left of the goals takes too long, or is refused, as well
        fresh, result = planner, SolveResult(SolveOutcome.INTERRUPTED, (), step, step)
    return Recovery(fresh, update, result, dropped, forgotten)


def requests_of(goals: Sequence[Goal]) -> FrozenSet[Symbol]:
    """The requests of the goals that were fed."""
    return frozenset(request(goal.term, goal.request_cycle) for goal in goals if goal.request_cycle is not None)
