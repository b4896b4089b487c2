"""Beliefs: the shown atoms of an answer that hold in the current cycle."""

from functools import lru_cache
from typing import Callable, Dict, FrozenSet, List, Optional, Tuple

from clingo import Function, Number, Symbol, SymbolType

from rosoclingo.reasoning.keywords import NOW

#: Returns the position of the cycle among the arguments of a predicate, by name and arity; None if it has no cycle.
TimePosition = Callable[[str, int], Optional[int]]

#: The atoms of an answer without a time, and the other atoms by time, each with the position of the time.
_Sorted = Tuple[List[Symbol], Dict[Symbol, List[Tuple[Symbol, int]]]]


class Present:
    """Extracts beliefs from answers. A repeated answer, in any cycle, is read once.

    ``position`` returns the position of the cycle, for predicates and for shown terms.
    """

    def __init__(self, position: TimePosition) -> None:
        self._position = lru_cache(maxsize=None)(position)
        self._sorted = lru_cache(maxsize=1)(self._sort)

    def of(self, answer: FrozenSet[Symbol], cycle: int) -> FrozenSet[Symbol]:
        """Return the atoms without a time, and the atoms of ``cycle`` with the constant ``now`` in its place."""
        timeless, timed = self._sorted(answer)
        return frozenset([*timeless, *(_at_now(*one) for one in timed.get(Number(cycle), ()))])

    def _sort(self, answer: FrozenSet[Symbol]) -> _Sorted:
        timeless: List[Symbol] = []
        timed: Dict[Symbol, List[Tuple[Symbol, int]]] = {}
        for atom in answer:
            is_function = atom.type is SymbolType.Function
            position = self._position(atom.name, len(atom.arguments)) if is_function else None
            if position is not None and atom.arguments[position].type is SymbolType.Number:
                timed.setdefault(atom.arguments[position], []).append((atom, position))
            else:
                timeless.append(atom)
        return timeless, timed


def _at_now(atom: Symbol, position: int) -> Symbol:
    arguments = atom.arguments
    arguments[position] = NOW
    return Function(atom.name, arguments, atom.positive)
