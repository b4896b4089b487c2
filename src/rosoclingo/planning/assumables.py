"""Facts of which each question says anew whether they were told."""

from typing import Dict, FrozenSet, Iterable, List

import clingo

from rosoclingo.oclingo.solving.atom_table import BackendSession
from rosoclingo.planning.snapshot import with_their_failures


class Assumables:
    """The assumable facts of one control.

    Attributes:
        facts: all of them.
        literals: fact -> the literal under which it was told; a return's failure has that of the return.

    """

    def __init__(self, session: BackendSession, facts: FrozenSet[clingo.Symbol]) -> None:
        self.facts = facts
        self._told: Dict[clingo.Symbol, int] = {}
        self.literals: Dict[clingo.Symbol, int] = {}
        for fact in sorted(facts):
            literal = self._told[fact] = session.backend.add_atom()
            session.backend.add_rule([literal], choice=True)
            for one in with_their_failures(frozenset([fact])):
                self.literals.setdefault(one, literal)
        self.literals.update(self._told)

    def assumptions(self, disabled: FrozenSet[clingo.Symbol]) -> List[int]:
        """Return the assumptions by which all facts but those ``disabled`` were told."""
        told = {self._told[fact] for fact in self.facts - disabled}  # to look each fact up would hash it in Python
        return [literal if literal in told else -literal for literal in self._told.values()]

    def among(self, core: Iterable[int]) -> FrozenSet[clingo.Symbol]:
        """Return the facts of which the assumptions in ``core`` are."""
        literals = set(map(abs, core))
        return frozenset(fact for fact, literal in self._told.items() if literal in literals)
