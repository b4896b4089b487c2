"""The atoms of a grounding: which externals can still be defined, and their definitions.

An external with a lapsing definition stays open: a second rule defines it by a new external, its next *cell*, which a
later definition defines in its place.
"""

from typing import ContextManager, Dict, Optional, Set

import clingo
from clingo.backend import Backend

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


class ControlAtoms:
    """Atoms of one control, and the literals that rules added through its session have for them.

    A body atom that is not ground yet gets a stand-in, which is tied to the atom once it is ground.
    """

    def __init__(self, control: clingo.Control, session: BackendSession, externals: ExternalIndex) -> None:
        """Take the control, its session and its externals."""
        self._control, self._session, self._externals = control, session, externals
        self._facts: Set[clingo.Symbol] = set()
        self._absent: Dict[clingo.Symbol, int] = {}  # body atom that is not ground yet -> its stand-in

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

    def resolve_absent(self) -> None:
        """Tie the stand-ins of body atoms to the atoms that have been ground since."""
        for atom in [one for one in self._absent if self.knows(one)]:
            backend = self._session.backend
            backend.add_rule([self._absent.pop(atom)], [backend.add_atom(atom)])

    def _head_literal(self, atom: clingo.Symbol) -> int:
        backend = self._session.backend
        fresh = not self.knows(atom)
        literal = backend.add_atom(atom)  # clingo sees to it that it does not hold together with its opposite
        if fresh and atom in self._absent:
            backend.add_rule([self._absent.pop(atom)], [literal])
        return int(literal)

    def _body_literal(self, literal: Literal) -> int:
        atom = literal.atom
        if self.knows(atom):
            code = int(self._session.backend.add_atom(atom))
        else:
            if atom not in self._absent:
                self._absent[atom] = self._session.new_external()
            code = self._absent[atom]
        return code if literal.positive else -code


class AtomTable(ControlAtoms):
    """Atoms of one control that updates can define and close, one update after the other."""

    def __init__(self, control: clingo.Control, session: BackendSession, externals: ExternalIndex) -> None:
        """Use a control, its session and its externals."""
        super().__init__(control, session, externals)
        self._next: Dict[clingo.Symbol, int] = {}  # defined atom -> the literal that the next definition defines
        self._closed: Dict[clingo.Symbol, int] = {}  # atom -> the update that closed it

    def is_closed(self, atom: clingo.Symbol) -> bool:
        """Return whether ``atom`` is defined for good, or was closed."""
        return atom in self._closed

    def is_open(self, atom: clingo.Symbol, update: int = _NEVER - 1) -> bool:
        """Return whether ``atom`` is an external that a statement of ``update``, by default a later one, can define."""
        return self._closed.get(atom, update) == update and (atom in self._next or self.is_external(atom))

    def add(self, entry: TimedStatement, guard: Optional[int]) -> None:
        """Add a rule, under ``guard`` if it can lapse; its head must be open or an atom that the program does not know.

        A permanent rule closes its head for later updates.
        """
        statement = entry.statement
        body = [self._body_literal(literal) for literal in statement.body] + ([] if guard is None else [guard])
        head = [] if statement.head is None else [self._head(statement.head, guard, entry.update)]
        self._session.backend.add_rule(head, body)
        if statement.head is not None and not body:
            self._facts.add(statement.head)

    def close(self, atom: clingo.Symbol) -> None:
        """Make the open external ``atom`` false for good."""
        self._closed[atom] = _NEVER
        literal = self._next.pop(atom, None)
        known = self._control.symbolic_atoms[atom]
        if literal is None and known is not None:
            literal = known.literal
        if literal is not None:
            self._session.release(literal)

    def _head(self, atom: clingo.Symbol, guard: Optional[int], update: int) -> int:
        """Return the literal to define for ``atom``; after a definition that lapses another one can follow."""
        literal = self._next.get(atom)
        if literal is None:
            literal = self._head_literal(atom)
        self._next[atom] = literal
        if guard is None:
            self._closed.setdefault(atom, update)
        elif atom not in self._closed:
            cell = self._next[atom] = self._session.new_external()
            self._session.backend.add_rule([literal], [cell])
        return literal
