"""What an answer shows of the present: what the program believes now, besides what it plans."""

from typing import Callable, Dict, FrozenSet, List, Optional, Tuple

from clingo import Function, Number, Symbol, SymbolType

from rosoclingo.reasoning.keywords import NOW

#: Tells by name and arity which argument of an atom is its cycle, None where none is.
TimePosition = Callable[[str, int], Optional[int]]


class Present:
    """Reads the present out of answers. An answer that comes again, in whatever cycle, is gone through once.

    ``position`` tells of each predicate, and of terms that are shown, which argument is the cycle.
    """

    def __init__(self, position: TimePosition) -> None:
        self._find = position
        self._positions: Dict[Tuple[str, int], Optional[int]] = {}
        self._answer: FrozenSet[Symbol] = frozenset()
        self._timeless: List[Symbol] = []
        self._timed: Dict[Symbol, List[Tuple[Symbol, int]]] = {}  # by their times, each with the position of that

    def of(self, answer: FrozenSet[Symbol], cycle: int) -> FrozenSet[Symbol]:
        """The atoms without a time, and those of the cycle, with the constant ``now`` in its place."""
        if answer is not self._answer:
            self._sort(answer)
        timed = self._timed.get(Number(cycle), ())
        return frozenset([*self._timeless, *(_at_now(*one) for one in timed)])

    def _sort(self, answer: FrozenSet[Symbol]) -> None:
        self._answer, self._timeless, self._timed = answer, [], {}
        for atom in answer:
            try:
                name, arguments = atom.name, atom.arguments
            except RuntimeError:  # a number or a string
                position = None
            else:
                position = self._position(name, len(arguments))
            if position is not None and arguments[position].type is SymbolType.Number:
                self._timed.setdefault(arguments[position], []).append((atom, position))
            else:
                self._timeless.append(atom)

    def _position(self, name: str, arity: int) -> Optional[int]:
        if (name, arity) not in self._positions:
            self._positions[name, arity] = self._find(name, arity)
        return self._positions[name, arity]


def _at_now(atom: Symbol, position: int) -> Symbol:
    arguments = atom.arguments
    arguments[position] = NOW
    return Function(atom.name, arguments, atom.positive)
