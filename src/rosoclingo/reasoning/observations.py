"""What was seen of the world: actions that failed, and facts that interfaces told. A goal may be at odds with it."""

from collections import deque
from typing import Deque, FrozenSet, NamedTuple, Tuple

from clingo import Symbol

from rosoclingo.reasoning.keywords import Action, Return, name_of, return_of

#: So many are kept; what is older is taken for granted.
MEMORY = 32


class Observation(NamedTuple):
    """A fact as it was fed, in ``cycle``; for the return of a failed action that action, or those it may be about."""

    atom: Symbol
    cycle: int
    actions: Tuple[Action, ...] = ()

    @property
    def facts(self) -> FrozenSet[Symbol]:
        """All that would not have been told without it: had the failed action not been tried."""
        return frozenset((self.atom, *(action.atom for action in self.actions)))

    def __str__(self) -> str:
        """The observation in words, for want of the program's own."""
        if not self.actions:
            return f"{self.atom} was told in cycle {self.cycle}"
        tried = " or ".join(f"{one.interface_name}({name_of(one.parameter)})" for one in self.actions)
        return f"{tried} returned {name_of(return_of(self.atom).value)} in cycle {self.cycle}"


class Observations:
    """The latest observations."""

    def __init__(self) -> None:
        self._kept: Deque[Observation] = deque(maxlen=MEMORY)

    @property
    def newest_first(self) -> Tuple[Observation, ...]:
        """All that are kept."""
        return tuple(reversed(self._kept))

    def add_fact(self, atom: Symbol, cycle: int) -> None:
        """A fact came that is no return."""
        self._kept.append(Observation(atom, cycle))

    def add_failure(self, answer: Return, actions: Tuple[Action, ...]) -> None:
        """One of ``actions`` returned something else than success."""
        self._kept.append(Observation(answer.atom, answer.cycle, actions))
