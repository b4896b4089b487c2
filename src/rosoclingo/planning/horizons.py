"""The horizon of an answer as literals, so that one grounding can be solved for any horizon or range of horizons.

``beyond(T)`` means that step T lies after the horizon. It is a choice that implies ``beyond(T+1)``. So the horizon is H
iff ``not beyond(H), beyond(H+1)``. An instance of ``#volatile t : w.`` at step S holds if S <= H <= S+w-1, that is, if
``not beyond(S), beyond(S+w)``.
"""

from typing import Dict, List

import clingo

from rosoclingo.oclingo.program.action_rules import BEYOND
from rosoclingo.oclingo.solving.atom_index import AtomIndex
from rosoclingo.oclingo.solving.definitions import HOLDS, OPEN, BackendSession


class HorizonLiterals:
    """The literals ``beyond(T)`` of one control, created on demand, and the atoms by which rules refer to them.

    Attributes:
        coming: step -> the literal of its atom, for steps that rules refer to and that are not grounded yet. These
            steps lie beyond the horizon.

    """

    def __init__(self, control: clingo.Control, session: BackendSession, before: int) -> None:
        """Start with step ``before``, which never lies beyond the horizon."""
        self._session = session
        self._last = before
        self._settled = before
        self._beyond: Dict[int, int] = {}
        self._index = AtomIndex(control, [BEYOND])
        self._linked: Dict[int, int] = {}  # ground step that can lie beyond -> literal of the rules' atom
        self.coming: Dict[int, int] = {}

    def expire(self) -> None:
        """Read the atoms again at the next use, because clingo can have grounded more of them."""
        self._index.expire()

    def beyond(self, step: int) -> int:
        """Return the literal ``beyond(step)``; create it and the literals of earlier steps if necessary."""
        while self._last < step:
            self._last += 1
            backend = self._session.backend  # opened only if needed: clasp has to prepare the program again
            literal = self._beyond[self._last] = backend.add_atom()
            backend.add_rule([literal], choice=True)
            if self._last - 1 in self._beyond:
                backend.add_rule([], [self._beyond[self._last - 1], -literal])
        return self._beyond[step]

    def define_window(self, guard: int, first: int, last: int) -> None:
        """Define ``guard``: true iff the horizon lies in first..last."""
        end = self.beyond(last + 1)
        self._session.backend.add_rule([guard], [end, -self.beyond(first)])

    def link(self, last: int) -> None:
        """Link the atoms in rules to the literals; all steps after ``last``, the last grounded step, lie beyond."""
        for atom, literal in self._index.fresh():
            cycle = atom.arguments[0]
            if cycle.type is clingo.SymbolType.Number and cycle.number > self._settled:
                self.coming[cycle.number] = literal
            else:
                self._session.release(literal)
        for step in sorted(self.coming):
            if step <= last:
                literal = self._linked[step] = self.coming.pop(step)
                self._session.backend.add_external(literal, OPEN)  # otherwise it would stay true if the body is false
                self._session.backend.add_rule([literal], [self.beyond(step)])
            else:
                self._session.backend.add_external(self.coming[step], HOLDS)

    def settle(self, step: int) -> None:
        """Exclude all horizons before ``step`` permanently, so that clingo can simplify the program."""
        for settled in range(self._settled + 1, step + 1):
            self._session.backend.add_rule([], [self.beyond(settled)])
            if settled in self._linked:
                # clingo drops the rule, whose body is false now. Without a rule the atom would be undefined.
                self._session.backend.add_rule([], [self._linked.pop(settled)])
        self._settled = max(self._settled, step)

    def range(self, first: int, last: int) -> List[int]:
        """Return the assumptions for a horizon in first..last."""
        end = self.beyond(last + 1)
        return [end] if first <= self._settled else [-self.beyond(first), end]

    def horizon_of(self, model: clingo.Model, first: int, last: int) -> int:
        """Return the horizon of ``model``, which lies in first..last."""
        return next((step for step in range(first, last) if model.is_true(self._beyond[step + 1])), last)
