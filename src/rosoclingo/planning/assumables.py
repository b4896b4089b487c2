"""Assumable facts, which a question can disable."""

from typing import Dict, FrozenSet, Iterable, List

import clingo

from rosoclingo.oclingo.program.update_reader import with_their_failures
from rosoclingo.oclingo.solving.definitions import BackendSession


class Assumables:
    """The assumable facts of one control, each guarded by a free literal.

    Attributes:
        facts: the assumable facts.
        literals: fact -> its guard; the failure of a return shares the guard of the return.

    """

    def __init__(self, session: BackendSession, facts: FrozenSet[clingo.Symbol]) -> None:
        self.facts = facts
        self._guards: Dict[clingo.Symbol, int] = {}
        self.literals: Dict[clingo.Symbol, int] = {}
        for fact in sorted(facts):
            literal = self._guards[fact] = session.backend.add_atom()
            session.backend.add_rule([literal], choice=True)
            for one in with_their_failures(frozenset([fact])):
                self.literals.setdefault(one, literal)
        self.literals.update(self._guards)

    def assumptions(self, disabled: FrozenSet[clingo.Symbol]) -> List[int]:
        """Return the assumptions that assert all facts except the ``disabled`` ones."""
        enabled = {self._guards[fact] for fact in self.facts - disabled}  # few lookups: symbols are hashed in Python
        return [literal if literal in enabled else -literal for literal in self._guards.values()]

    def among(self, core: Iterable[int]) -> FrozenSet[clingo.Symbol]:
        """Return the facts whose guards occur in ``core``."""
        literals = set(map(abs, core))
        return frozenset(fact for fact, literal in self._guards.items() if literal in literals)
