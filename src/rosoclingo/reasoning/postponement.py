"""Which goals can be taken out of the program as if it had never been told of them: those that nothing was done for."""

import math
from typing import Any, Callable, List, Optional, Sequence, Tuple

from rosoclingo.oclingo import SolveOutcome, SolverError, Statement, StreamUpdate
from rosoclingo.oclingo.progression.updates import Item, Withdraw
from rosoclingo.reasoning.goal_manager import GoalManager
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import requests_of
from rosoclingo.reasoning.keywords import Action, cancellation, success_of
from rosoclingo.reasoning.stream_planner import Planner


def put_off(
    planner: Planner,
    manager: GoalManager,
    chosen: Sequence[Goal],
    fresh: Sequence[Goal],
    why: str,
    told: int,
    executed: Optional[Sequence[Action]] = None,
    look: Callable[[], Any] = lambda: None,
) -> Tuple[Planner, str]:
    """Take those of the ``chosen`` goals that are not in hand out of the program; what was too much: ``why``.

    Cancelled goals without executed actions are withdrawn instead, and end. If all chosen goals are in hand, the
    others wait. ``fresh`` goals came with the last update; updates were published up to cycle ``told``. Goals of an
    update that is not in force can always wait. So can those that came after the last of the ``executed`` actions, if
    these are known: nothing was done for them. The search for further ones ends when ``look()`` is not None.

    Returns the planner that goes on, and a text about the goals. Raises DisturbedError, with nothing changed.
    """
    last = math.inf if executed is None else max((action.cycle for action in executed), default=0)
    first = max(last + 1, planner.log.keep_from)
    fresh = [goal for goal in manager.fed if goal in fresh or (goal.request_cycle or 0) > first]
    fed = manager.fed
    over = [goal for goal in fed if goal.cancelling and (goal.request_cycle or 0) > first]
    if over:
        planner = planner.restarted(requests_of(over))
        manager.take_out(over, told)
        return planner, f"{why}: {len(over)} of {len(fed)} goals are taken out, as they were cancelled"
    others = [goal for goal in fed if goal not in chosen and not goal.cancelling] if chosen else []
    trial = _Trial(planner, fed, fresh, executed or (), look)
    gone = _postponable(planner, chosen, fresh, trial) or _postponable(planner, others, fresh, trial)
    if not gone:
        manager.queue.stay(chosen)
        return planner, f"{why}: the search goes on"
    planner = planner.restarted(requests_of(gone))
    number = len({*fed, *gone})
    manager.defer(gone, f"{number} goals were too much: {why}", told)
    return planner, f"{why}: {len(gone)} of {number} goals wait"


def _postponable(planner: Planner, chosen: Sequence[Goal], fresh: Sequence[Goal], trial: "_Trial") -> List[Goal]:
    """Return those of the ``chosen`` goals that are not in hand; ``fresh`` ones cannot be.

    A goal is in hand unless it makes no difference whether it is withdrawn, as if it had never been told, or cancelled:
    with all other goals cancelled there is a plan of the same length. What was picked up for a goal has to be
    brought back when that is cancelled; and without its request it could never have been picked up. The trial retracts
    the success returns, since a program can use them as evidence that the action was possible.
    """
    new = [goal for goal in chosen if goal in fresh or not goal.fed]
    old = [goal for goal in chosen if goal not in new and (goal.request_cycle or 0) > planner.log.keep_from]
    gone = [*new, *trial.untouched(old)] if old else new
    return [goal for goal in chosen if goal in gone]


class _Trial:
    """Plans beside the stream in which each goal is withdrawn or cancelled."""

    def __init__(
        self,
        planner: Planner,
        fed: Sequence[Goal],
        fresh: Sequence[Goal],
        executed: Sequence[Action],
        look: Callable[[], Any],
    ) -> None:
        self._planner, self._look = planner, look
        self._successes = frozenset(success_of(action) for action in executed if action.cycle > planner.log.keep_from)
        self._old = [goal for goal in fed if goal not in fresh]
        self._fresh = [goal for goal in fed if goal in fresh]
        self._steps = planner.lookahead

    def untouched(self, goals: Sequence[Goal]) -> List[Goal]:
        """The goals that can be withdrawn."""
        steps = self._plan(())
        if steps is None:
            return []
        self._steps = steps
        return self._among([], goals)

    def _among(self, found: List[Goal], goals: Sequence[Goal]) -> List[Goal]:
        """Return the goals that can be withdrawn together with those found, as far as time permits."""
        if self._look() is not None:
            return []
        if self._plan([*found, *goals]) is not None:
            return list(goals)
        if len(goals) == 1:
            return []
        half = len(goals) // 2
        some = self._among(found, goals[:half])
        return [*some, *self._among([*found, *some], goals[half:])]

    def _plan(self, withdrawn: Sequence[Goal]) -> Optional[int]:
        """How many steps a plan has with some goals withdrawn and the others cancelled; None where none was found."""
        gone, step = requests_of([*self._fresh, *withdrawn]), self._planner.log.step + 1
        cancels = [Statement(cancellation(one.identifier, step)) for one in self._old if one not in withdrawn]
        items: List[Item] = [*map(Withdraw, sorted(gone)), *cancels]
        beside = self._planner.restarted(gone | self._successes)
        beside.lookahead = self._steps
        try:
            result = beside.update(StreamUpdate(step, items=tuple(items)))
        except SolverError:
            return None
        return result.horizon - step if result.outcome is SolveOutcome.SATISFIABLE else None
