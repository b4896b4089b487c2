"""Removes superfluous actions and idle steps from plans.

An action is superfluous if the plan stays valid without it and the actions that depend on it (action elimination,
Nakhost and Mueller 2010). The solver searches for a plan with a proper subset of the actions until there is none. It
assumes all other actions false, which is slow if there are many. A program with ``#heuristic`` statements is assumed to
plan no superfluous actions, unless several robots act: each of them could do what another one plans to do.
"""

from contextlib import suppress
from typing import Generator

from rosoclingo.oclingo.errors import StoppedError
from rosoclingo.oclingo.program.action_rules import RUNNING
from rosoclingo.planning.history import Plan, cycle_of, delay
from rosoclingo.planning.question import Assumptions, Question, Reply
from rosoclingo.planning.strategy_runner import StrategyRunner

CONFLICTS = 1000
"""Limit of conflicts for a question; most questions need few."""

_Trimmed = Generator[Question, Reply, Reply]


def trimmed(found: Reply, runner: StrategyRunner, step: int, first: int, present: Assumptions = ()) -> _Trimmed:
    """Return the plan ``found`` without superfluous actions and idle steps after ``step``.

    ``first`` is the least possible horizon; ``present`` are the assumptions about the actions up to ``step``. A stop
    ends the trimming; the result is the best plan so far.
    """
    advises = runner.program.advises
    trusted = advises and not runner.program.declares_external(RUNNING.name, RUNNING.arity)

    def question(plan: Plan, first: int, last: int, fewer: bool) -> Question:
        """Return the question for ``plan``, or for a proper subset of its actions."""
        others = [] if trusted else [one for one in runner.actions(step + 1, last) if one not in plan.actions]
        given = [*present, *((one, False) for one in others), *((one, True) for one in plan.actions if not fewer)]
        lacking = tuple(plan.actions if fewer else ())
        return Question(first, last, given, lacking, conflicts=CONFLICTS, advised=not (advises and fewer))

    def without_idling(found: Reply) -> _Trimmed:
        """Return the plan without idle steps, or at least without idle steps at its end."""
        plan = found.plan.rest(step + 1)
        for shorter in dict.fromkeys((_without_idling(plan, step), plan)):
            end = max(first, step, shorter.last_cycle)
            if end < found.horizon:
                sooner = yield question(shorter, end, end, fewer=False)
                if sooner.satisfiable:
                    return sooner
        return found

    with suppress(StoppedError):
        found = yield from without_idling(found)  # questions about fewer steps are cheaper
        fewer = found
        while fewer.satisfiable and not trusted and found.plan.rest(step + 1).actions:
            fewer = yield question(found.plan.rest(step + 1), first, found.horizon, fewer=True)
            found = fewer if fewer.satisfiable else found
        if not trusted:
            found = yield from without_idling(found)
    return found


def _without_idling(plan: Plan, step: int) -> Plan:
    """Return ``plan``, which begins after ``step``, without idle steps."""
    cycles = {cycle: number for number, cycle in enumerate(sorted(set(map(cycle_of, plan.actions))), step + 1)}
    return plan._replace(actions=frozenset(delay(one, cycles[cycle_of(one)] - cycle_of(one)) for one in plan.actions))
