"""The last plan of a stream: where a search begins, never a part of the state."""

from typing import FrozenSet, Iterable, NamedTuple

import clingo

from rosoclingo.oclingo.program.action_rules import is_action


class Plan(NamedTuple):
    """The actions of an answer.

    Attributes:
        actions: its ``_action_lib`` atoms.
        horizon: that of the answer.
        shortest: whether it was proven that there is no shorter one.

    """

    actions: FrozenSet[clingo.Symbol]
    horizon: int
    shortest: bool = False

    @classmethod
    def of(cls, atoms: Iterable[clingo.Symbol], horizon: int, shortest: bool = False) -> "Plan":
        """Return the plan in an answer's ``atoms``."""
        return cls(frozenset(atom for atom in atoms if is_action(atom) and _has_number(atom)), horizon, shortest)

    def since(self, cycle: int) -> "Plan":
        """Return what is to be done from ``cycle`` on."""
        return self._replace(actions=frozenset(one for one in self.actions if cycle_of(one) >= cycle))

    def later(self) -> "Plan":
        """Return the same done one cycle later, as where an action has failed and is tried again."""
        actions = (
            clingo.Function(one.name, [*one.arguments[:2], clingo.Number(cycle_of(one) + 1)]) for one in self.actions
        )
        return Plan(frozenset(actions), self.horizon + 1)

    @property
    def last_cycle(self) -> int:
        """The cycle of the last action; less than any where there is none."""
        return max(map(cycle_of, self.actions), default=-(2**31))


def cycle_of(action: clingo.Symbol) -> int:
    """Return the cycle of an action."""
    return int(action.arguments[2].number)


def _has_number(action: clingo.Symbol) -> bool:
    return action.arguments[2].type == clingo.SymbolType.Number
