"""Observations of the world: failed actions, and facts from interfaces."""

from typing import FrozenSet, NamedTuple, Optional, Tuple

from clingo import Symbol

from rosoclingo.reasoning.keywords import RETURN, Action, is_keyword, name_of, return_of

#: The number of observations that the core remembers.
MEMORY = 32


class Observation(NamedTuple):
    """A fact of the stream.

    Attributes:
        atom: the fact as it was fed.
        cycle: the cycle in which it arrived.
        actions: for a failure return, the failed action, or all actions that the return can refer to.
        origin: the interface that sent the fact.
        original: the fact as it was sent, None if it was not changed.
        outdated: whether the fact was late and was redated to the present.
        message: the number of its message; later messages have greater numbers.
        attempts: how often it was omitted although its update had no other facts; None if no update has omitted it.

    """

    atom: Symbol
    cycle: int
    actions: Tuple[Action, ...] = ()
    origin: str = ""
    original: Optional[Symbol] = None
    outdated: bool = False
    message: int = 0
    attempts: Optional[int] = None

    @property
    def sent(self) -> Symbol:
        """The fact as it was sent."""
        return self.original or self.atom

    @property
    def facts(self) -> FrozenSet[Symbol]:
        """The atoms that were stated because of it: the fact, and the commitments to its failed actions."""
        return frozenset((self.atom, *(action.atom for action in self.actions)))

    @property
    def is_return(self) -> bool:
        """Whether it is the return of an action."""
        return is_keyword(self.atom, RETURN)

    def __str__(self) -> str:
        """The observation in words, for programs without ``_explain``."""
        if not self.actions:
            return f"{self.atom} was reported in cycle {self.cycle}"
        tried = " or ".join(f"{one.interface_name}({name_of(one.parameter)})" for one in self.actions)
        return f"{tried} returned {name_of(return_of(self.atom).value)} in cycle {self.cycle}"


class UnhandledFailure(NamedTuple):
    """A failure that the program cannot handle.

    ``undone`` is true if its actions count as not done. It is None if no rule uses the failure, and it is not known
    yet whether the actions can count as not done.
    """

    failure: Observation
    undone: Optional[bool] = None
