"""Adds the statements of a stream to a control, and tracks which externals are open to further definitions."""

from typing import Collection, ContextManager, Dict, Iterable, Iterator, Optional, Set

import clingo
from clingo.backend import Backend

from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.updates import Literal
from rosoclingo.oclingo.solving.atom_index import ExternalIndex
from rosoclingo.oclingo.solving.stream_state import TimedStatement

OPEN, HOLDS, RELEASED = clingo.TruthValue.False_, clingo.TruthValue.True_, clingo.TruthValue.Release

_NEVER = -1
"""The update number of externals that are closed without a definition."""


class BackendSession:
    """A backend that stays open between two groundings or searches, as opening one takes milliseconds."""

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
        """Commit all changes. Call this before grounding or searching."""
        if self._session is not None:
            session, self._session, self._backend = self._session, None, None
            session.__exit__(None, None, None)

    def new_external(self, value: clingo.TruthValue = OPEN) -> int:
        """Add an external without a symbol and return its literal."""
        literal = self.backend.add_atom()
        self.backend.add_external(literal, value)
        return literal

    def release(self, literal: int) -> None:
        """Make an external permanently false."""
        self.backend.add_external(literal, RELEASED)


class Definitions:
    """The statements added to a control, and the externals that are open to further definitions.

    A permanent statement closes its head for later updates; a lapsing or assumable statement does not. A placeholder
    external represents a body atom until the atom is grounded.
    """

    def __init__(
        self, control: clingo.Control, session: BackendSession, externals: ExternalIndex, reopens: bool = False
    ) -> None:
        """Add statements to ``control`` through ``session``.

        If it ``reopens`` heads, lapsing statements can be added between searches. Their heads stay open: an extra rule
        derives the head from a new external, its *cell*. The next statement for the head defines the cell.
        """
        self._control, self._session, self._externals = control, session, externals
        self._reopens = reopens
        self._facts: Set[clingo.Symbol] = set()
        self._absent: Dict[clingo.Symbol, int] = {}  # body atom that is not grounded yet -> its placeholder
        self._in_bodies: Set[clingo.Symbol] = set()
        self._heads: Dict[clingo.Symbol, int] = {}  # head -> the literal that its last statement defines
        self._cells: Dict[clingo.Symbol, int] = {}  # head -> its cell
        self._closed: Dict[clingo.Symbol, int] = {}  # atom -> the update that closed it

    # ---- Atoms -------------------------------------------------------------------------------------------------------

    def knows(self, atom: clingo.Symbol) -> bool:
        """Return whether the grounding contains ``atom``."""
        return atom in self._control.symbolic_atoms

    def is_true(self, atom: clingo.Symbol) -> bool:
        """Return whether ``atom`` is a fact."""
        known = self._control.symbolic_atoms[atom]
        return atom in self._facts or (known is not None and bool(known.is_fact))

    def is_external(self, atom: clingo.Symbol) -> bool:
        """Return whether ``atom`` was declared external, and no rule of the program defines it."""
        # clingo's own ``is_external`` is unreliable: it is also True for atoms that a rule makes equivalent to an
        # external, and it is lost once the program is permanently unsatisfiable
        known = self._control.symbolic_atoms[atom]
        return known is not None and self._externals.is_external(known.literal)

    def is_closed(self, atom: clingo.Symbol, update: int = _NEVER - 1) -> bool:
        """Return whether ``atom`` is closed to statements of ``update`` (default: a later update)."""
        return self._closed.get(atom, update) != update

    def is_open(self, atom: clingo.Symbol, update: int = _NEVER - 1) -> bool:
        """Return whether statements of ``update`` (default: a later update) can define the external ``atom``."""
        return not self.is_closed(atom, update) and (atom in self._heads or self.is_external(atom))

    def is_undefined(self, atom: clingo.Symbol) -> bool:
        """Return whether ``atom`` is an external that no statement defines."""
        return atom not in self._closed and atom not in self._heads and self.is_external(atom)

    def is_in_body(self, atom: clingo.Symbol) -> bool:
        """Return whether the body of a statement contains ``atom``."""
        return atom in self._in_bodies

    @property
    def false(self) -> Iterator[clingo.Symbol]:
        """The atoms that were closed without a definition."""
        return (atom for atom, update in self._closed.items() if update == _NEVER)

    @property
    def absent(self) -> Collection[clingo.Symbol]:
        """The body atoms that are not grounded yet."""
        return self._absent.keys()

    # ---- Changes -----------------------------------------------------------------------------------------------------

    def add(self, entry: TimedStatement, guards: Iterable[int] = (), assumable: bool = False) -> None:
        """Add a statement with ``guards`` in its body; its head must be open, or unknown to the program."""
        statement, is_permanent = entry.statement, entry.lifetime == FOREVER and not assumable
        head = statement.head
        self._in_bodies.update(one.atom for one in statement.body)
        body = [*map(self._body_literal, statement.body), *guards]
        if head is None:
            self._session.backend.add_rule([], body)
            return
        literal = self._heads[head] = self._literal_to_define(head, is_permanent)
        self._session.backend.add_rule([literal], body)
        if is_permanent:
            self._closed.setdefault(head, entry.update)
            if not statement.body:
                self._facts.add(head)
        elif self._reopens and head not in self._closed:
            cell = self._cells[head] = self._session.new_external()
            self._session.backend.add_rule([literal], [cell])

    def close(self, atom: clingo.Symbol, update: int = _NEVER) -> None:
        """Close ``atom`` to the statements after ``update``, by default to all; without any definition it is false."""
        self._closed[atom] = update
        known = self._control.symbolic_atoms[atom]
        if atom in self._cells:
            self._session.release(self._cells.pop(atom))
        elif known is not None and atom not in self._heads:
            self._session.release(known.literal)

    def resolve_absent(self) -> None:
        """Link the placeholders of newly grounded body atoms to these atoms."""
        for atom in [one for one in self._absent if self.knows(one)]:
            backend = self._session.backend
            backend.add_rule([self._absent.pop(atom)], [backend.add_atom(atom)])

    def _literal_to_define(self, head: clingo.Symbol, is_permanent: bool) -> int:
        if head in self._cells:
            return self._cells.pop(head)
        if head in self._heads:
            return self._heads[head]
        backend, known = self._session.backend, self._control.symbolic_atoms[head]
        if known is not None and is_permanent and self.is_external(head):
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
