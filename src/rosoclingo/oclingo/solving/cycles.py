"""The actions of each cycle in one control, and the constraints of closed cycles."""

import math
from types import MappingProxyType
from typing import Collection, Container, Dict, Iterable, List, Mapping, Set, Tuple

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
        first: float = -math.inf,
        executed: Mapping[clingo.Symbol, int] = MappingProxyType({}),
    ) -> None:
        """Index the actions in ``control``; the actions before the ``first`` cycle are facts.

        ``executed`` maps each assumable action to the literal that is true if it was executed.
        """
        super().__init__(control, [ACTION])
        self._session, self._first, self._executed = session, first, executed
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
        for cycle in [one for one in self._open() if one in self._closed or one < self._first]:
            self._forbid(cycle)

    def _open(self) -> Collection[int]:
        """Return the cycles whose actions are not forbidden, including newly grounded ones."""
        for atom, literal in self.fresh():
            cycle = atom.arguments[-1]
            if cycle.type is clingo.SymbolType.Number:
                self._cycles.setdefault(cycle.number, []).append((atom, literal))
        return self._cycles.keys()

    def _forbid(self, cycle: int) -> None:
        self._open()
        for atom, literal in self._cycles.pop(cycle, []):
            known = self._control.symbolic_atoms[atom]
            is_fact = known is not None and known.is_fact
            if not (atom in self._closed[cycle] if cycle in self._closed else is_fact):
                self._session.backend.add_rule([], [literal])
            elif atom in self._executed:
                self._session.backend.add_rule([], [literal, -self._executed[atom]])
