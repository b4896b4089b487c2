"""Plans without superfluous actions and without idle steps.

An action is superfluous if the plan remains one without it, and without the actions that only it makes possible
(Nakhost and Mueller's action elimination, 2010). The solver looks for a plan with some of the actions, not all of them,
and no others, until there is none. For that it assumes all other actions false, which takes long if there are many.
A program with ``#heuristic`` statements is trusted to hold no superfluous actions.
"""

from typing import Callable, List, Tuple

import clingo

from rosoclingo.oclingo.solving.assumptions import Search
from rosoclingo.oclingo.solving.grounding import Grounding
from rosoclingo.oclingo.solving.stream_log import Plan, cycle_of

CONFLICTS = 1000
"""Limit of conflicts for the question for fewer actions; most take a few."""

IDLE_CONFLICTS = 100
"""Limit of conflicts for the question for the same actions without idle steps."""

Given = List[Tuple[clingo.Symbol, bool]]

Ask = Callable[[int, int, Given, int], Search]
"""Asks for a plan, given its first and last horizon, assumed actions, and a limit of conflicts."""


def trimmed(found: Search, step: int, first: int, grounding: Grounding, ask: Ask) -> Search:
    """Return the plan that was ``found``, without superfluous actions after ``step`` and without idle steps.

    No plan has a horizon before ``first``. A question without an answer leaves the plan as it is.
    """

    def others(plan: Plan, last: int) -> Given:
        """Return the assumption of no actions up to ``last`` other than the plan's."""
        if grounding.program.advises:
            return []
        return [(one, False) for one in grounding.actions(step + 1, last) if one not in plan.actions]

    plan, fewer = plan_after(found, step), found
    while fewer.satisfiable and plan.actions and not grounding.program.advises:
        with grounding.lacking(plan.actions):
            fewer = ask(first, found.horizon, others(plan, found.horizon), CONFLICTS)
        if fewer.satisfiable:
            found, plan = fewer, plan_after(fewer, step)
    packed = without_idling(plan, step)
    for shorter in (packed, plan) if packed.actions != plan.actions else (plan,):
        end = max(first, step, shorter.last_cycle)
        if end < found.horizon:
            sooner = ask(end, end, [*((one, True) for one in shorter.actions), *others(shorter, end)], IDLE_CONFLICTS)
            if sooner.satisfiable:
                return sooner
    return found


def plan_after(found: Search, step: int) -> Plan:
    """Return the part after ``step`` of the plan that was ``found``."""
    return Plan.of(found.answers[-1], found.horizon).since(step + 1)


def without_idling(plan: Plan, step: int) -> Plan:
    """Return ``plan``, which begins after ``step``, without its idle steps."""
    cycles = {cycle: number for number, cycle in enumerate(sorted(set(map(cycle_of, plan.actions))), step + 1)}
    return plan._replace(actions=frozenset(moved(one, cycles[cycle_of(one)] - cycle_of(one)) for one in plan.actions))


def moved(action: clingo.Symbol, steps: int) -> clingo.Symbol:
    """Return the same action ``steps`` steps later."""
    return clingo.Function(action.name, [*action.arguments[:2], clingo.Number(cycle_of(action) + steps)])
