"""The statements of a stream as rules of one control, and the externals that are open to further definitions."""

from typing import Collection, ContextManager, Dict, Iterable, Optional, Set

import clingo
from clingo.backend import Backend

from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.updates import Literal
from rosoclingo.oclingo.solving.atom_index import ExternalIndex
from rosoclingo.oclingo.solving.stream_state import TimedStatement

OPEN, HOLDS, RELEASED = clingo.TruthValue.False_, clingo.TruthValue.True_, clingo.TruthValue.Release

_NEVER = -1
"""Number of the update that closes an external without a definition."""


class BackendSession:
    """One open backend for all changes of a control between groundings and searches: opening it costs milliseconds."""

    def __init__(self, control: clingo.Control) -> None:
        self._control = control
        self._session: Optional[ContextManager[Backend]] = None
        self._backend: Optional[Backend] = None

    @property
    def backend(self) -> Backend:
        """The open backend; opened on first use."""
        if self._backend is None:
            self._session = self._control.backend()
            self._backend = self._session.__enter__()
        return self._backend

    def close(self) -> None:
        """Pass all changes to clingo; to be called before it grounds or searches."""
        if self._session is not None:
            session, self._session, self._backend = self._session, None, None
            session.__exit__(None, None, None)

    def new_external(self, value: clingo.TruthValue = OPEN) -> int:
        """Return a new nameless external."""
        literal = self.backend.add_atom()
        self.backend.add_external(literal, value)
        return literal

    def release(self, literal: int) -> None:
        """Make an external false for good."""
        self.backend.add_external(literal, RELEASED)


class Definitions:
    """Statements that were added to a control through its session, and the externals that are still open.

    A permanent statement closes its head for later updates; one that lapses or is assumable does not. A body atom that
    is not ground yet gets a stand-in, which is tied to the atom once it is ground.
    """

    def __init__(
        self, control: clingo.Control, session: BackendSession, externals: ExternalIndex, reopens: bool = False
    ) -> None:
        """Use a control, its session and its externals.

        If it ``reopens`` heads, statements that lapse can be added between searches. Their heads stay open: a second
        rule defines the head by a new external, its next *cell*, which a later statement defines in its place.
        """
        self._control, self._session, self._externals = control, session, externals
        self._reopens = reopens
        self._facts: Set[clingo.Symbol] = set()
        self._absent: Dict[clingo.Symbol, int] = {}  # body atom that is not ground yet -> its stand-in
        self._in_bodies: Set[clingo.Symbol] = set()
        self._heads: Dict[clingo.Symbol, int] = {}  # head of a statement -> the literal that it defines
        self._cells: Dict[clingo.Symbol, int] = {}  # head -> the external that a later statement defines
        self._closed: Dict[clingo.Symbol, int] = {}  # atom -> the update that closed it

    # ---- Atoms -------------------------------------------------------------------------------------------------------

    def knows(self, atom: clingo.Symbol) -> bool:
        """Return whether some ground rule or external mentions ``atom`` as possible."""
        return atom in self._control.symbolic_atoms

    def is_true(self, atom: clingo.Symbol) -> bool:
        """Return whether ``atom`` is known as a fact."""
        known = self._control.symbolic_atoms[atom]
        return atom in self._facts or (known is not None and bool(known.is_fact))

    def is_external(self, atom: clingo.Symbol) -> bool:
        """Return whether ``atom`` was declared external, and no rule of the program defines it."""
        # clingo's own ``is_external`` is no help: it is True for what a rule makes equivalent to an external, and lost
        # once the program can never be satisfied
        known = self._control.symbolic_atoms[atom]
        return known is not None and self._externals.is_external(known.literal)

    def is_closed(self, atom: clingo.Symbol, update: int = _NEVER - 1) -> bool:
        """Return whether ``atom`` is closed for a statement of ``update``, by default of a later one."""
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

    # ---- Changes -----------------------------------------------------------------------------------------------------

    def add(self, entry: TimedStatement, guards: Iterable[int] = (), assumable: bool = False) -> None:
        """Add a statement with ``guards`` in its body; its head is open, or the program does not know it."""
        statement, lasts = entry.statement, entry.lifetime == FOREVER and not assumable
        head = statement.head
        self._in_bodies.update(one.atom for one in statement.body)
        body = [*map(self._body_literal, statement.body), *guards]
        if head is None:
            self._session.backend.add_rule([], body)
            return
        literal = self._heads[head] = self._literal_to_define(head, lasts)
        self._session.backend.add_rule([literal], body)
        if lasts:
            self._closed.setdefault(head, entry.update)
            if not statement.body:
                self._facts.add(head)
        elif self._reopens and head not in self._closed:
            cell = self._cells[head] = self._session.new_external()
            self._session.backend.add_rule([literal], [cell])

    def close(self, atom: clingo.Symbol) -> None:
        """Close ``atom`` to further definitions; without any definition it becomes false permanently."""
        self._closed[atom] = _NEVER
        known = self._control.symbolic_atoms[atom]
        if atom in self._cells:
            self._session.release(self._cells.pop(atom))
        elif known is not None and atom not in self._heads:
            self._session.release(known.literal)

    def resolve_absent(self) -> None:
        """Tie the stand-ins of body atoms to the atoms that have been ground since."""
        for atom in [one for one in self._absent if self.knows(one)]:
            backend = self._session.backend
            backend.add_rule([self._absent.pop(atom)], [backend.add_atom(atom)])

    def _literal_to_define(self, head: clingo.Symbol, lasts: bool) -> int:
        if head in self._cells:
            return self._cells.pop(head)
        if head in self._heads:
            return self._heads[head]
        backend, known = self._session.backend, self._control.symbolic_atoms[head]
        if known is not None and lasts and self.is_external(head):
            self._session.release(known.literal)  # otherwise the external stays open if clasp removes its rules
        literal = int(backend.add_atom(head))  # clingo excludes the opposite atom
        if known is None and head in self._absent:
            backend.add_rule([self._absent.pop(head)], [literal])
        return literal

    def _body_literal(self, literal: Literal) -> int:
        atom = literal.atom
        if self.knows(atom):
            code = int(self._session.backend.add_atom(atom))
        else:
            if atom not in self._absent:
                self._absent[atom] = self._session.new_external()
            code = self._absent[atom]
        return code if literal.positive else -code
