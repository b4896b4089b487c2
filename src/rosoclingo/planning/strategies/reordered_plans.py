"""Plans that do what a plan does in another order."""

from random import Random
from typing import Iterator, List, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import ACTION
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.reordering.known_ways import Deed
from rosoclingo.planning.reordering.other_orders import Orders

EFFORT = 40_000
"""So many orders are looked at, one after the other, that there are as many tasks in all of them."""

LOOK = 10
"""So many of them between two looks at the stop request."""


class ReorderedPlans:
    """What shorter plans might be, where another order is all that differs; the less often asked, the less it brings.

    It begins with what is true on most floors, that a robot can go back to where it came from, and does without where
    that brings nothing, and so on in turns.
    """

    def __init__(self) -> None:
        self._random = Random(0)
        self._orders: Optional[Orders] = None
        self._of: Optional[Tuple[Plan, int]] = None
        self._tried, self._useful = 1, 1
        self._back = True

    def shorter(self, plan: Plan, step: int) -> Iterator[Optional[Plan]]:
        """Yield plans that are shorter than ``plan`` and each other, if they are plans; all is free behind ``step``.

        Yields None between, as it takes a while to find them.
        """
        if self._random.random() * self._tried >= self._useful:
            return
        if self._of != (plan, step):
            self._orders, self._of = self._read(plan, step), (plan, step)
        orders = self._orders
        rounds = 0 if orders is None else EFFORT // max(1, orders.tasks)
        for number, deeds in enumerate(() if orders is None else orders.shorter(rounds), 1):
            if deeds is not None:
                yield _plan_of(deeds, step)
            elif number % LOOK == 0:
                yield None

    def learn(self, useful: bool) -> None:
        """Learn whether one of the plans was one."""
        self._tried += 1
        self._useful += useful
        if not useful:
            self._orders, self._of, self._back = None, None, not self._back

    def _read(self, plan: Plan, step: int) -> Optional[Orders]:
        """Return the orders of a plan; None where it does several things at once."""
        actions = sorted(plan.actions, key=cycle_of)
        deeds = [(action.arguments[0], action.arguments[1]) for action in actions]
        done = sum(cycle_of(action) <= step for action in actions)
        if len({*map(cycle_of, actions[done:])}) < len(actions) - done:
            return None
        return Orders(deeds[:done], deeds[done:], self._random, self._back, self._orders)


def _plan_of(deeds: Sequence[Deed], step: int) -> Plan:
    """Return the plan that does ``deeds``, one after the other, behind a step."""
    actions: List[clingo.Symbol] = [
        clingo.Function(ACTION.name, [*deed, clingo.Number(cycle)]) for cycle, deed in enumerate(deeds, step + 1)
    ]
    return Plan(frozenset(actions), step + len(deeds))
