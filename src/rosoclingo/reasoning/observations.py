"""What was observed of the world: failed actions, and facts from interfaces. Goals may contradict it."""

from typing import FrozenSet, NamedTuple, Optional, Tuple

from clingo import Symbol

from rosoclingo.reasoning.keywords import RETURN, Action, is_keyword, name_of, return_of
from rosoclingo.reasoning.records import Record, actions_of, actions_to_text, symbol_of, text_of

#: The number of observations that the core remembers.
MEMORY = 32


class Observation(NamedTuple):
    """A fact as it was fed, in ``cycle``; for the return of a failed action that action, or those it can be about.

    ``origin`` is the interface that sent it, ``original`` the fact as it was sent, None for the same. An ``outdated``
    fact came too late and was redated to the present. ``message`` is greater for a later message.
    """

    atom: Symbol
    cycle: int
    actions: Tuple[Action, ...] = ()
    origin: str = ""
    original: Optional[Symbol] = None
    outdated: bool = False
    message: int = 0

    @property
    def sent(self) -> Symbol:
        """The fact as it was sent."""
        return self.original or self.atom

    @property
    def facts(self) -> FrozenSet[Symbol]:
        """All that would not have been stated without it, had the failed action not been tried."""
        return frozenset((self.atom, *(action.atom for action in self.actions)))

    @property
    def is_return(self) -> bool:
        """Whether it is how an action ended."""
        return is_keyword(self.atom, RETURN)

    def record(self) -> Record:
        """Return the observation as a plain value."""
        original = None if self.original is None else text_of(self.original)
        symbols = {"atom": text_of(self.atom), "actions": actions_to_text(self.actions), "original": original}
        return {**self._asdict(), **symbols}

    @classmethod
    def of_record(cls, record: Record) -> "Observation":
        """Return the observation of :meth:`record`."""
        original = None if record["original"] is None else symbol_of(record["original"])
        symbols = {"atom": symbol_of(record["atom"]), "actions": actions_of(record["actions"]), "original": original}
        return cls(**{**record, **symbols})

    def __str__(self) -> str:
        """The observation in words, for want of the program's own."""
        if not self.actions:
            return f"{self.atom} was told in cycle {self.cycle}"
        tried = " or ".join(f"{one.interface_name}({name_of(one.parameter)})" for one in self.actions)
        return f"{tried} returned {name_of(return_of(self.atom).value)} in cycle {self.cycle}"


class UnhandledFailure(NamedTuple):
    """A failure that the program cannot handle.

    ``undone`` tells whether its actions count as not done. None: no rule looks at the failure, and whether the actions
    can count as not done is still to be found out.
    """

    failure: Observation
    undone: Optional[bool] = None
