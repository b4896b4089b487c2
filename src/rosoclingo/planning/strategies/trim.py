"""Plans without superfluous actions and without idle steps.

An action is superfluous if the plan remains one without it, and without the actions that only it makes possible
(Nakhost and Mueller's action elimination, 2010). The solver looks for a plan with some of the actions, not all of them,
and no others, until there is none. For that it assumes all other actions false, which takes long if there are many.
A program with ``#heuristic`` statements is trusted to hold no superfluous actions.
"""

from contextlib import suppress
from typing import Generator, Iterable, Optional

import clingo

from rosoclingo.planning.asking import Asking
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.question import Given, Question, Reply, Stop, StoppedError

CONFLICTS = 1000
"""Limit of conflicts for the question for fewer actions; most take a few."""

IDLE_CONFLICTS = 100
"""Limit of conflicts for the question for the same actions without idle steps."""

_Trimmed = Generator[Question, Reply, Reply]


def trimmed(
    found: Reply, asking: Asking, step: int, first: int, present: Given = (), until: Optional[Stop] = None
) -> _Trimmed:
    """Return the plan that was ``found``, without superfluous actions after ``step`` and without idle steps.

    No plan has a horizon before ``first``. What is done up to ``step`` is ``present``. A question without an answer
    leaves the plan as it is, and a stop ends the questions.
    """

    def others(plan: Plan, last: int) -> Given:
        """Return the assumption of no actions up to ``last`` other than the plan's."""
        if asking.program.advises:
            return []
        return [(one, False) for one in asking.actions(step + 1, last) if one not in plan.actions]

    def ask(first: int, last: int, given: Given, conflicts: int, lacking: Iterable[clingo.Symbol] = ()) -> Question:
        """Return the question for a part of the plan."""
        return Question(first, last, [*present, *given], tuple(lacking), conflicts=conflicts, until=until)

    plan, fewer = plan_after(found, step), found
    with suppress(StoppedError):
        while fewer.satisfiable and plan.actions and not asking.program.advises:
            fewer = yield ask(first, found.horizon, others(plan, found.horizon), CONFLICTS, plan.actions)
            if fewer.satisfiable:
                found, plan = fewer, plan_after(fewer, step)
        packed = without_idling(plan, step)
        for shorter in (packed, plan) if packed.actions != plan.actions else (plan,):
            end = max(first, step, shorter.last_cycle)
            if end < found.horizon:
                given = [*((one, True) for one in shorter.actions), *others(shorter, end)]
                sooner = yield ask(end, end, given, IDLE_CONFLICTS)
                if sooner.satisfiable:
                    return sooner
    return found


def plan_after(found: Reply, step: int) -> Plan:
    """Return the part after ``step`` of the plan that was ``found``."""
    return Plan.of(found.answers[-1], found.horizon).since(step + 1)


def without_idling(plan: Plan, step: int) -> Plan:
    """Return ``plan``, which begins after ``step``, without its idle steps."""
    cycles = {cycle: number for number, cycle in enumerate(sorted(set(map(cycle_of, plan.actions))), step + 1)}
    return plan._replace(actions=frozenset(moved(one, cycles[cycle_of(one)] - cycle_of(one)) for one in plan.actions))


def moved(action: clingo.Symbol, steps: int) -> clingo.Symbol:
    """Return the same action ``steps`` steps later."""
    return clingo.Function(action.name, [*action.arguments[:2], clingo.Number(cycle_of(action) + steps)])
