"""Removes superfluous actions and idle steps from plans.

An action is superfluous if the plan stays valid without it and the actions that depend on it (action elimination,
Nakhost and Mueller 2010). The solver searches for a plan with a proper subset of the actions until there is none. It
assumes all other actions false, which is slow if there are many. A program with ``#heuristic`` statements is assumed to
plan no superfluous actions, unless several robots act: each of them could do what another one plans to do.
"""

from contextlib import suppress
from typing import Generator, Optional

from rosoclingo.oclingo.errors import StoppedError
from rosoclingo.planning.history import Plan, cycle_of, delay
from rosoclingo.planning.question import Assumptions, Question, Reply, Strategy
from rosoclingo.planning.strategy_runner import StrategyRunner

CONFLICTS = 1000
"""Limit of conflicts for a question; most questions need few."""


def trimmed(found: Reply, runner: StrategyRunner, step: int, first: int) -> Generator[Question, Reply, Reply]:
    """Return the plan ``found``, trimmed after ``step``.

    ``first`` is the least possible horizon. A stop ends the trimming; the result is the best plan so far.
    """
    better: Optional[Reply] = found
    with suppress(StoppedError):
        while better is not None:
            found = better
            better = yield from trim(found.plan, runner, step, first)
    return found


def trim(
    plan: Plan, runner: StrategyRunner, step: int, first: int, present: Assumptions = ()
) -> Strategy[Optional[Reply]]:
    """Return a plan that has fewer idle steps or actions after ``step`` than ``plan``; None for none.

    ``first`` is the least possible horizon; ``present`` are the assumptions about the actions up to ``step``.
    """
    advises = runner.program.advises
    trusted, rest = advises and not runner.program.actions_go_on, plan.rest(step + 1)

    def question(plan: Plan, first: int, last: int, fewer: bool = False) -> Question:
        """Return the question for ``plan``, or for a proper subset of its actions."""
        others = [] if trusted else [one for one in runner.actions(step + 1, last) if one not in plan.actions]
        given = [*present, *((one, False) for one in others), *((one, True) for one in plan.actions if not fewer)]
        lacking = tuple(plan.actions if fewer else ())
        return Question(first, last, given, lacking, conflicts=CONFLICTS, advised=not (advises and fewer))

    for shorter in dict.fromkeys((_without_idling(rest, step), rest)):  # without idle steps, or only without the last
        end = max(first, step, shorter.last_cycle)
        if end < plan.horizon:
            sooner = yield question(shorter, end, end)
            if sooner.satisfiable:
                return sooner
    if trusted or not rest.actions:
        return None
    fewer = yield question(rest, first, plan.horizon, fewer=True)
    return fewer if fewer.satisfiable else None


def _without_idling(plan: Plan, step: int) -> Plan:
    """Return ``plan``, which begins after ``step``, without idle steps."""
    cycles = {cycle: number for number, cycle in enumerate(sorted(set(map(cycle_of, plan.actions))), step + 1)}
    return plan._replace(actions=frozenset(delay(one, cycles[cycle_of(one)] - cycle_of(one)) for one in plan.actions))
