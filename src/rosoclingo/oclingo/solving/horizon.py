"""The horizon of an answer as literals: one grounding can be asked for any horizon, or for the least of a range.

``beyond(T)`` says that step T lies beyond the horizon. It is free, but once true it stays true for all later steps;
so the horizon H is where ``not beyond(H), beyond(H+1)``, and an instance of ``#volatile t : w.`` of step S, which
holds while S <= H <= S+w-1, holds where ``not beyond(S), beyond(S+w)``.
"""

from typing import Dict, List

import clingo

from rosoclingo.oclingo.program.action_rules import BEYOND
from rosoclingo.oclingo.solving.atom_table import BackendSession


class HorizonLiterals:
    """The literals ``beyond(T)`` of one control, made as they are needed."""

    def __init__(self, control: clingo.Control, session: BackendSession, before: int) -> None:
        """Start with step ``before``, which never lies beyond."""
        self._control, self._session = control, session
        self._last = before
        self._settled = before
        self._beyond: Dict[int, int] = {}
        self._linked = before
        self._names: Dict[int, int] = {}  # step -> the literal of the program's name for it

    def _literal(self, step: int) -> int:
        """Return the literal ``beyond(step)``, making it and those before it."""
        backend = self._session.backend
        while self._last < step:
            self._last += 1
            literal = self._beyond[self._last] = backend.add_atom()
            backend.add_rule([literal], choice=True)
            if self._last - 1 in self._beyond:
                backend.add_rule([], [self._beyond[self._last - 1], -literal])
        return self._beyond[step]

    def define_window(self, guard: int, step: int, window: int) -> None:
        """Define ``guard``: true where the horizon lies in step..step+window-1."""
        end = self._literal(step + window)
        self._session.backend.add_rule([guard], [end, -self._literal(step)])

    def forbid_beyond(self, step: int) -> None:
        """Tie the program's ``__oclingo_beyond(T)`` for T around ``step`` to the literals."""
        while self._linked < step + 1:
            name = clingo.Function(BEYOND, [clingo.Number(self._linked + 1)])
            atom = self._control.symbolic_atoms[name]
            if atom is None and self._linked + 1 > step - 1:
                return  # an action of that cycle may still come with a later step
            self._linked += 1
            if atom is not None:
                self._names[self._linked] = atom.literal
                self._session.backend.add_rule([atom.literal], [self._literal(self._linked)])
                self._end(range(self._linked, self._settled + 1))

    def settle(self, step: int) -> None:
        """Say for good that no horizon lies before ``step``, which lets clingo simplify."""
        for settled in range(self._settled + 1, step + 1):
            self._session.backend.add_rule([], [self._literal(settled)])
        self._end(range(self._settled + 1, step + 1))
        self._settled = max(self._settled, step)

    def _end(self, steps: range) -> None:
        """Say for good that ``steps``, or those of them that the program has a name for, do not lie beyond.

        The rule is not enough: its body is false now, and an external without a rule is open to clingo.
        """
        for step in steps:
            if step in self._names:
                self._session.backend.add_rule([], [self._names.pop(step)])

    def range(self, first: int, last: int) -> List[int]:
        """Return the assumptions by which the horizon lies in first..last."""
        end = self._literal(last + 1)
        return [end] if first <= self._settled else [-self._literal(first), end]

    def horizon_of(self, model: clingo.Model, first: int, last: int) -> int:
        """Return the horizon, known to lie in first..last, of ``model``."""
        return next((step for step in range(first, last) if model.is_true(self._beyond[step + 1])), last)
