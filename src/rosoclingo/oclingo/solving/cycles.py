"""The atoms of each cycle in one control, and what closed cycles allow of their actions."""

from typing import Collection, Container, Dict, Iterable, List, Mapping, Optional, Set, Tuple

import clingo

from rosoclingo.oclingo.progression.terms import Signature
from rosoclingo.oclingo.solving.atom_index import AtomIndex
from rosoclingo.oclingo.solving.atom_table import BackendSession


class CycleIndex(AtomIndex):
    """The atoms of a keyword like ``_return/3``, sorted by the cycle that is their last argument."""

    def __init__(self, control: clingo.Control, signature: Signature) -> None:
        super().__init__(control, [signature])
        self._cycles: Dict[int, List[Tuple[clingo.Symbol, int]]] = {}

    def cycles(self) -> Collection[int]:
        """Return the cycles whose atoms, or some of them, have not been popped."""
        for atom, literal in self.fresh():
            cycle = atom.arguments[-1]
            if cycle.type is clingo.SymbolType.Number:
                self._cycles.setdefault(cycle.number, []).append((atom, literal))
        return self._cycles.keys()

    def pop_cycle(self, cycle: int) -> List[Tuple[clingo.Symbol, int]]:
        """Return, once, the atoms of ``cycle`` that are known by now, with their literals."""
        return self._cycles.pop(cycle, []) if cycle in self.cycles() else []

    def among(self, atoms: Container[clingo.Symbol]) -> List[clingo.Symbol]:
        """Return those of the ``atoms`` that have not been popped."""
        return [atom for cycle in self.cycles() for atom, _ in self._cycles[cycle] if atom in atoms]

    def between(self, first: int, last: int) -> List[clingo.Symbol]:
        """Return the atoms of the cycles first..last that have not been popped."""
        known = self.cycles()
        return [atom for cycle in range(first, last + 1) if cycle in known for atom, _ in self._cycles[cycle]]


class ActionIndex(CycleIndex):
    """The ``_action_lib`` atoms of each cycle, and what closed cycles allow of them."""

    def __init__(
        self,
        control: clingo.Control,
        session: BackendSession,
        signature: Signature,
        first: Optional[int] = None,
        told: Optional[Mapping[clingo.Symbol, int]] = None,
    ) -> None:
        """Take the signature, and the ``first`` cycle of all: those before it hold what the program says for sure.

        ``told`` maps each assumable action to the literal under which it was executed.
        """
        super().__init__(control, signature)
        self._session, self._first = session, first
        self._told: Mapping[clingo.Symbol, int] = {} if told is None else told
        self._closed: Dict[int, Set[clingo.Symbol]] = {}

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Forbid all actions of ``cycle`` but ``executed``, those that come later as well."""
        self._closed[cycle] = set(executed)
        self._forbid(cycle)

    def forbid_late(self) -> None:
        """Forbid actions of cycles that are over which came with the last grounding."""
        for cycle in [one for one in self.cycles() if one in self._closed or self._is_before(one)]:
            self._forbid(cycle)

    def _is_before(self, cycle: int) -> bool:
        return self._first is not None and cycle < self._first

    def _may_be(self, atom: clingo.Symbol, cycle: int) -> bool:
        if cycle in self._closed:
            return atom in self._closed[cycle]
        known = self._control.symbolic_atoms[atom]
        return known is not None and known.is_fact

    def _forbid(self, cycle: int) -> None:
        for atom, literal in self.pop_cycle(cycle):
            if not self._may_be(atom, cycle):
                self._session.backend.add_rule([], [literal])
            elif atom in self._told:
                self._session.backend.add_rule([], [literal, -self._told[atom]])
