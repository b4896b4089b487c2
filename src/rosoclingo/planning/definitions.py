"""The statements of a snapshot as rules of one control."""

from typing import Collection, Dict, Iterable, Set

import clingo

from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.solving.atom_index import ExternalIndex
from rosoclingo.oclingo.solving.atom_table import BackendSession, ControlAtoms
from rosoclingo.oclingo.solving.stream_state import TimedStatement

_NEVER = -1
"""Number of the update that closes an external without a definition."""


class Definitions(ControlAtoms):
    """Statements that were added to a control, and the externals that are open to further definitions.

    A permanent statement closes its head for later updates. A statement that lapses or is assumable does not.
    """

    def __init__(self, control: clingo.Control, session: BackendSession, externals: ExternalIndex) -> None:
        """Use a control, its session and its externals."""
        super().__init__(control, session, externals)
        self._closed: Dict[clingo.Symbol, int] = {}  # head -> the update that closed it
        self._heads: Set[clingo.Symbol] = set()  # of all statements
        self._in_bodies: Set[clingo.Symbol] = set()

    def is_closed(self, atom: clingo.Symbol, update: int = _NEVER - 1) -> bool:
        """Return whether ``atom`` is closed for a statement of ``update``."""
        return self._closed.get(atom, update) != update

    def is_open(self, atom: clingo.Symbol, update: int = _NEVER - 1) -> bool:
        """Return whether ``atom`` is an external that a statement of ``update`` can define."""
        return not self.is_closed(atom, update) and (atom in self._heads or self.is_external(atom))

    def is_undefined(self, atom: clingo.Symbol) -> bool:
        """Return whether ``atom`` is an external that no statement defines."""
        return atom not in self._closed and atom not in self._heads and self.is_external(atom)

    def is_in_body(self, atom: clingo.Symbol) -> bool:
        """Return whether a body of a statement contains ``atom``."""
        return atom in self._in_bodies

    @property
    def absent(self) -> Collection[clingo.Symbol]:
        """Atoms of bodies that are not grounded yet."""
        return self._absent.keys()

    def add(self, entry: TimedStatement, guards: Iterable[int] = (), assumable: bool = False) -> None:
        """Add a statement, whose head is open, with ``guards`` in the body."""
        statement, lasts = entry.statement, entry.lifetime == FOREVER and not assumable
        head = statement.head
        self._in_bodies.update(one.atom for one in statement.body)
        known = None if head is None else self._control.symbolic_atoms[head]
        if head is not None and known is not None and lasts and self.is_external(head):
            # otherwise the external stays open if clasp removes its rules
            self._session.release(known.literal)
        body = [*map(self._body_literal, statement.body), *guards]
        self._session.backend.add_rule([] if head is None else [self._head_literal(head)], body)
        if head is not None:
            self._heads.add(head)
        if head is not None and lasts:
            self._closed.setdefault(head, entry.update)
            if not statement.body:
                self._facts.add(head)

    def close(self, atom: clingo.Symbol) -> None:
        """Close ``atom`` to further definitions; without any definition it becomes false permanently."""
        self._closed[atom] = _NEVER
        known = self._control.symbolic_atoms[atom]
        if known is not None and atom not in self._heads:
            self._session.release(known.literal)
