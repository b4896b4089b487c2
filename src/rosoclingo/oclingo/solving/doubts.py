"""Facts in doubt: those of which each search says anew whether they were told."""

from typing import Dict, FrozenSet, Iterable, List, Optional

import clingo

from rosoclingo.oclingo.program.return_failures import with_their_failures
from rosoclingo.oclingo.progression.updates import Statement
from rosoclingo.oclingo.solving.atom_table import BackendSession


class Doubts:
    """The facts in doubt of one control.

    Attributes:
        literals: fact -> the literal under which it was told; a return's failure has that of the return.

    """

    def __init__(self, session: BackendSession, facts: FrozenSet[clingo.Symbol]) -> None:
        self._told: Dict[clingo.Symbol, int] = {}
        self.literals: Dict[clingo.Symbol, int] = {}
        for fact in sorted(facts):
            literal = self._told[fact] = session.backend.add_atom()
            session.backend.add_rule([literal], choice=True)
            for one in with_their_failures(frozenset([fact])):
                self.literals.setdefault(one, literal)
        self.literals.update(self._told)

    def literal_of(self, statement: Statement) -> Optional[int]:
        """Return the literal under which ``statement`` was made; None where it is not in doubt."""
        return None if statement.subject is None else self.literals.get(statement.subject)

    def assumptions(self, untold: FrozenSet[clingo.Symbol]) -> List[int]:
        """Return the assumptions by which all facts but those ``untold`` were told."""
        return [-literal if fact in untold else literal for fact, literal in self._told.items()]

    def among(self, core: Iterable[int]) -> FrozenSet[clingo.Symbol]:
        """Return the facts of which the assumptions in ``core`` are."""
        literals = set(map(abs, core))
        return frozenset(fact for fact, literal in self._told.items() if literal in literals)
