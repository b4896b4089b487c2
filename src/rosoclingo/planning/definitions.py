"""Statements of a snapshot in one control: which of them define their heads, and by which rules."""

from typing import Collection, Container, Dict, Iterable, Set

import clingo

from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.solving.atom_table import BackendSession, ControlAtoms
from rosoclingo.planning.snapshot import TimedStatement

_NEVER = -1
"""The update that has closed an external that no statement defines."""


class Definitions(ControlAtoms):
    """The statements that were added to a control, and the externals that others can still define.

    A statement that holds for ever closes its head behind its own update. One that lapses, or can be assumed away, does
    not.
    """

    def __init__(
        self, control: clingo.Control, session: BackendSession, declared: Container[int], defined: Container[int]
    ) -> None:
        """Take the control, its session, the literals of declared externals, and those of them that rules define."""
        super().__init__(control, session, declared, defined)
        self._closed: Dict[clingo.Symbol, int] = {}  # head -> the update that has closed it
        self._heads: Set[clingo.Symbol] = set()  # of all statements
        self._asked: Set[clingo.Symbol] = set()

    def is_closed(self, atom: clingo.Symbol, update: int = _NEVER - 1) -> bool:
        """Whether ``atom`` is closed for a statement of ``update``."""
        return self._closed.get(atom, update) != update

    def is_open(self, atom: clingo.Symbol, update: int = _NEVER - 1) -> bool:
        """Whether ``atom`` is an external that a statement of ``update`` can define."""
        return not self.is_closed(atom, update) and (atom in self._heads or self.is_external(atom))

    def is_undefined(self, atom: clingo.Symbol) -> bool:
        """Whether ``atom`` is an external that no statement defines."""
        return atom not in self._closed and atom not in self._heads and self.is_external(atom)

    def is_asked(self, atom: clingo.Symbol) -> bool:
        """Whether the body of a statement mentions ``atom``."""
        return atom in self._asked

    @property
    def awaited(self) -> Collection[clingo.Symbol]:
        """The atoms that bodies mention and nothing has brought yet."""
        return self._absent.keys()

    def add(self, told: TimedStatement, guards: Iterable[int] = (), assumable: bool = False) -> None:
        """Add a statement, whose head is open, under ``guards``."""
        statement, lasts = told.statement, told.lifetime == FOREVER and not assumable
        head = statement.head
        self._asked.update(one.atom for one in statement.body)
        known = None if head is None else self._control.symbolic_atoms[head]
        if head is not None and known is not None and lasts and self.is_external(head):
            # else clasp takes it for open where its rules turn out to be of no use
            self._session.release(known.literal)
        body = [*map(self._body_literal, statement.body), *guards]
        self._session.backend.add_rule([] if head is None else [self._head_literal(head)], body)
        if head is not None:
            self._heads.add(head)
        if head is not None and lasts:
            self._closed.setdefault(head, told.update)
            if not statement.body:
                self._facts.add(head)

    def close(self, atom: clingo.Symbol) -> None:
        """Let no further statement define ``atom``: an external that none defines is false for good."""
        self._closed[atom] = _NEVER
        known = self._control.symbolic_atoms[atom]
        if known is not None and atom not in self._heads:
            self._session.release(known.literal)
