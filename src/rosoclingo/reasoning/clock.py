"""Which cycle a fact is of: its last argument, or the constant ``now`` in that place."""

from typing import Callable, Optional

from clingo import Function, Number, Symbol, SymbolType

#: In place of the cycle: as soon as can be.
NOW = Function("now")


class Clock:
    """Gives facts of now their cycle.

    ``delay(name, arity)`` tells after how many cycles what is seen of such a fact bears on actions: in update n, which
    starts cycle n, a fact of cycle n - delay is the first that the action of cycle n heeds. None stands for a
    predicate whose last argument is no cycle. ``first`` is the first cycle that there is.
    """

    def __init__(self, delay: Callable[[str, int], Optional[int]] = lambda name, arity: 0, first: int = 1) -> None:
        self._delay = delay
        self._first = first

    def dated(self, fact: Symbol, step: int) -> Symbol:
        """``fact`` as the update of ``step`` is to state it; it stays as it is unless it is of now."""
        return self.at_present(fact, step) if _is_of_now(fact) else fact

    def is_too_early(self, fact: Symbol, step: int) -> bool:
        """Whether a fact of now would need a cycle before the first one to take effect at ``step``."""
        return _is_of_now(fact) and step - self._delay_of(fact) < self._first

    def at_present(self, fact: Symbol, step: int) -> Symbol:
        """``fact`` as if seen just now, its last argument replaced."""
        cycle = max(step - self._delay_of(fact), self._first)
        return Function(fact.name, [*fact.arguments[:-1], Number(cycle)], fact.positive)

    def cycle_of(self, fact: Symbol) -> Optional[int]:
        """The cycle of a fact; None where its predicate knows none, or it is none."""
        if not fact.arguments or self._delay(fact.name, len(fact.arguments)) is None:
            return None
        last = fact.arguments[-1]
        return last.number if last.type is SymbolType.Number else None

    def _delay_of(self, fact: Symbol) -> int:
        return self._delay(fact.name, len(fact.arguments)) or 0


def _is_of_now(fact: Symbol) -> bool:
    return bool(fact.arguments) and fact.arguments[-1] == NOW
