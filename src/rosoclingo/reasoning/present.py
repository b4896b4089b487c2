"""Beliefs: the shown atoms of an answer that hold in the current cycle."""

from functools import lru_cache
from typing import Callable, Dict, FrozenSet, List, Optional, Tuple

from clingo import Function, Number, Symbol, SymbolType

from rosoclingo.reasoning.keywords import NOW

#: Returns the position of the cycle among the arguments of a predicate, by name and arity; None if it has no cycle.
TimePosition = Callable[[str, int], Optional[int]]

#: The atoms of an answer without a time, and the other atoms by time, each with its arguments, ``now`` for the time.
_Sorted = Tuple[List[Symbol], Dict[Symbol, List[Tuple[Symbol, List[Symbol]]]]]


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
        now = (Function(one.name, arguments, one.positive) for one, arguments in timed.get(Number(cycle), ()))
        return frozenset([*timeless, *now])

    def _sort(self, answer: FrozenSet[Symbol]) -> _Sorted:
        timeless: List[Symbol] = []
        timed: Dict[Symbol, List[Tuple[Symbol, List[Symbol]]]] = {}
        for atom in answer:
            arguments = atom.arguments if atom.type is SymbolType.Function else None
            position = None if arguments is None else self._position(atom.name, len(arguments))
            if arguments is not None and position is not None and arguments[position].type is SymbolType.Number:
                time, arguments[position] = arguments[position], NOW
                timed.setdefault(time, []).append((atom, arguments))
            else:
                timeless.append(atom)
        return timeless, timed
