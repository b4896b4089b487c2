"""The actions of each cycle in one control, and the constraints of closed cycles."""

from typing import Collection, Container, Dict, Iterable, List, Mapping, Optional, Set, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import ACTION
from rosoclingo.oclingo.solving.atom_index import AtomIndex
from rosoclingo.oclingo.solving.definitions import BackendSession


class ActionIndex(AtomIndex):
    """The ``_action_lib(A,P,C)`` atoms, of open cycles, sorted by their cycle C."""

    def __init__(
        self,
        control: clingo.Control,
        session: BackendSession,
        first: Optional[int] = None,
        executed: Optional[Mapping[clingo.Symbol, int]] = None,
    ) -> None:
        """Index the actions in ``control``; the actions before the ``first`` cycle are facts.

        ``executed`` maps each assumable action to the literal that is true if it was executed.
        """
        super().__init__(control, [ACTION])
        self._session, self._first = session, first
        self._executed: Mapping[clingo.Symbol, int] = {} if executed is None else executed
        self._cycles: Dict[int, List[Tuple[clingo.Symbol, int]]] = {}
        self._closed: Dict[int, Set[clingo.Symbol]] = {}

    def among(self, atoms: Container[clingo.Symbol]) -> List[clingo.Symbol]:
        """Return the actions of open cycles that ``atoms`` contains."""
        return [atom for cycle in self._open() for atom, _ in self._cycles[cycle] if atom in atoms]

    def between(self, first: int, last: int) -> List[clingo.Symbol]:
        """Return the actions of open cycles from ``first`` to ``last``."""
        known = self._open()
        return [atom for cycle in range(first, last + 1) if cycle in known for atom, _ in self._cycles[cycle]]

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Forbid all actions of ``cycle`` except ``executed``, including actions that are grounded later."""
        self._closed[cycle] = set(executed)
        self._forbid(cycle)

    def forbid_late(self) -> None:
        """Forbid newly grounded actions of closed or compacted cycles, unless they were executed."""
        for cycle in [one for one in self._open() if one in self._closed or self._is_before(one)]:
            self._forbid(cycle)

    def _open(self) -> Collection[int]:
        """Return the cycles whose actions are not forbidden, including newly grounded ones."""
        for atom, literal in self.fresh():
            cycle = atom.arguments[-1]
            if cycle.type is clingo.SymbolType.Number:
                self._cycles.setdefault(cycle.number, []).append((atom, literal))
        return self._cycles.keys()

    def _is_before(self, cycle: int) -> bool:
        return self._first is not None and cycle < self._first

    def _is_allowed(self, atom: clingo.Symbol, cycle: int) -> bool:
        if cycle in self._closed:
            return atom in self._closed[cycle]
        known = self._control.symbolic_atoms[atom]
        return known is not None and known.is_fact

    def _forbid(self, cycle: int) -> None:
        self._open()
        for atom, literal in self._cycles.pop(cycle, []):
            if not self._is_allowed(atom, cycle):
                self._session.backend.add_rule([], [literal])
            elif atom in self._executed:
                self._session.backend.add_rule([], [literal, -self._executed[atom]])
