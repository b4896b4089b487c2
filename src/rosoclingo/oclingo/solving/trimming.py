"""Plans without superfluous actions and without idle steps.

An action is superfluous where the plan remains one without it, and without the actions that only it makes possible
(Nakhost and Mueller's action elimination, 2010). The solver finds these: it is asked for a plan that holds some of the
actions, not all of them, and no others, until there is none.
"""

from typing import Callable, List, Sequence, Tuple

import clingo

from rosoclingo.oclingo.solving.assumptions import Search
from rosoclingo.oclingo.solving.stream_log import Plan, cycle_of

CONFLICTS = 1000
"""Conflicts that one question may take; most take a few."""

Given = List[Tuple[clingo.Symbol, bool]]

Ask = Callable[[int, int, Given, Sequence[clingo.Symbol]], Search]
"""Asks for a plan, given its first and last horizon, assumed actions, and actions of which one at least is left out."""


def trimmed(
    found: Search, step: int, first: int, actions: Callable[[int, int], List[clingo.Symbol]], ask: Ask
) -> Search:
    """Return the plan that was ``found``, without what is superfluous after ``step``, its steps moved together.

    No plan has a horizon before ``first``; ``actions`` returns the actions of some cycles that can be in a plan. A
    question without an answer leaves the plan as it is.
    """
    plan = plan_after(found, step)
    fewer = found
    while fewer.satisfiable and plan.actions:
        others = [(one, False) for one in actions(step + 1, found.horizon) if one not in plan.actions]
        fewer = ask(first, found.horizon, others, sorted(plan.actions))
        if fewer.satisfiable:
            found, plan = fewer, plan_after(fewer, step)
    packed = without_idling(plan, step)
    for shorter in (packed, plan) if packed.actions != plan.actions else (plan,):
        end = max(first, step, shorter.last_cycle)
        if end < found.horizon:
            given = [(one, one in shorter.actions) for one in actions(step + 1, end)]
            sooner = ask(end, end, given, ())
            if sooner.satisfiable and shorter.actions <= sooner.answers[-1]:
                return sooner
    return found


def plan_after(found: Search, step: int) -> Plan:
    """Return what is done after ``step`` in the plan that was ``found``."""
    return Plan.of(found.answers[-1], found.horizon).since(step + 1)


def without_idling(plan: Plan, step: int) -> Plan:
    """Return ``plan``, which begins after ``step``, without the steps at which nothing is done."""
    cycles = {cycle: number for number, cycle in enumerate(sorted(set(map(cycle_of, plan.actions))), step + 1)}
    return plan._replace(actions=frozenset(moved(one, cycles[cycle_of(one)] - cycle_of(one)) for one in plan.actions))


def moved(action: clingo.Symbol, steps: int) -> clingo.Symbol:
    """Return the same action so many steps later."""
    return clingo.Function(action.name, [*action.arguments[:2], clingo.Number(cycle_of(action) + steps)])
