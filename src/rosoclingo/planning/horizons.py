"""The horizon of an answer as literals.

By these literals one grounding can be asked for any horizon, or for the least of a range. ``beyond(T)`` says that step
T lies beyond the horizon. It is free, but once true it stays true for all later steps; so the horizon H is where
``not beyond(H), beyond(H+1)``, and an instance of ``#volatile t : w.`` of step S, which holds while S <= H <= S+w-1,
holds where ``not beyond(S), beyond(S+w)``.
"""

from typing import Collection, Dict, List

import clingo

from rosoclingo.oclingo.program.action_rules import BEYOND
from rosoclingo.oclingo.solving.atom_index import AtomIndex
from rosoclingo.oclingo.solving.atom_table import HOLDS, OPEN, BackendSession


class HorizonLiterals:
    """The literals ``beyond(T)`` of one control, made as they are needed, and the program's names for them."""

    def __init__(self, control: clingo.Control, session: BackendSession, before: int) -> None:
        """Start with step ``before``, which never lies beyond."""
        self._session = session
        self._last = before
        self._settled = before
        self._beyond: Dict[int, int] = {}
        self._index = AtomIndex(control, [BEYOND])
        self._known: Dict[int, int] = {}  # grounded step that may lie beyond -> literal of the program's name for it
        self._coming: Dict[int, int] = {}  # step that is not grounded yet -> likewise

    def expire(self) -> None:
        """Note that there may be new names."""
        self._index.expire()

    @property
    def coming(self) -> Collection[int]:
        """The steps that rules name and that are not grounded yet: what is of them is forbidden until they are."""
        return self._coming.keys()

    def _literal(self, step: int) -> int:
        """Return the literal ``beyond(step)``, making it and those before it."""
        while self._last < step:
            self._last += 1
            backend = self._session.backend  # to open one has clasp prepare the program again
            literal = self._beyond[self._last] = backend.add_atom()
            backend.add_rule([literal], choice=True)
            if self._last - 1 in self._beyond:
                backend.add_rule([], [self._beyond[self._last - 1], -literal])
        return self._beyond[step]

    def beyond(self, step: int) -> int:
        """Return the literal that ``step`` lies beyond the horizon."""
        return self._literal(step)

    def define_window(self, guard: int, step: int, window: int) -> None:
        """Define ``guard``: true where the horizon lies in step..step+window-1."""
        end = self._literal(step + window)
        self._session.backend.add_rule([guard], [end, -self._literal(step)])

    def link(self, last: int) -> None:
        """Tie the program's names to the literals; all steps after ``last``, which is grounded, lie beyond."""
        for atom, name in self._index.fresh():
            cycle = atom.arguments[0]
            if cycle.type is clingo.SymbolType.Number and cycle.number > self._settled:
                self._coming[cycle.number] = name
            else:
                self._session.release(name)
        for step in sorted(self._coming):
            if step <= last:
                name = self._known[step] = self._coming.pop(step)
                self._session.backend.add_external(name, OPEN)  # else it would stay true where its rule is of no use
                self._session.backend.add_rule([name], [self._literal(step)])
            else:
                self._session.backend.add_external(self._coming[step], HOLDS)

    def settle(self, step: int) -> None:
        """Say for good that no horizon lies before ``step``, which lets clingo simplify."""
        for settled in range(self._settled + 1, step + 1):
            self._session.backend.add_rule([], [self._literal(settled)])
            if settled in self._known:
                # its rule is not enough: it goes where its body is false now, and without a rule the name is open
                self._session.backend.add_rule([], [self._known.pop(settled)])
        self._settled = max(self._settled, step)

    def range(self, first: int, last: int) -> List[int]:
        """Return the assumptions by which the horizon lies in first..last."""
        end = self._literal(last + 1)
        return [end] if first <= self._settled else [-self._literal(first), end]

    def horizon_of(self, model: clingo.Model, first: int, last: int) -> int:
        """Return the horizon, known to lie in first..last, of ``model``."""
        return next((step for step in range(first, last) if model.is_true(self._beyond[step + 1])), last)
