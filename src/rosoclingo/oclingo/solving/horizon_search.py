"""The search for answers of one update: at which horizons to ask, and when to grow."""

import time
from typing import Any, Callable, Optional
from weakref import WeakKeyDictionary

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.solving.assumptions import Search
from rosoclingo.oclingo.solving.grounding import Grounding
from rosoclingo.oclingo.solving.transaction import Transaction


class HorizonSearch:
    """One update's search.

    Attributes:
        seconds: wall time spent in clingo's search so far.
        answered: the processor time of this process when there was an answer that would do, None where only the end
            gives it.
        permanent: True once nothing can make the program satisfiable again.
        hopeless: True once no horizon has an answer, unless something is told.
        proven: True once an answer is known to be of the least horizon.

    """

    def __init__(self, models: int, shortest: bool, hint: int, block: int, halt: Callable[[], bool]) -> None:
        """Prepare to search for ``models`` answers.

        ``hint`` is a likely horizon (that of the last one), ``block`` the number of steps to grow by.
        """
        self._models, self._shortest, self._hint, self._halt = models, shortest, hint, halt
        self._block = block
        self.seconds = 0.0
        self.answered: Optional[float] = None
        self.permanent = self.hopeless = False
        self.proven = False

    def run(self, transaction: Transaction) -> Search:
        """Search at the grounded horizons, then grow until there is an answer or no more may be grounded."""
        found = self._search_grounded(transaction)
        while found.satisfiable is False and not self.hopeless and transaction.may_grow():
            if self._halt():
                return Search(None)
            first = transaction.state.horizon + 1
            transaction.grow(self._block)
            found = self._search_block(transaction, first, transaction.state.horizon)
        self.proven = bool(found.satisfiable) and self._shortest
        return found

    def _search_block(self, transaction: Transaction, first: int, last: int) -> Search:
        found = self._ask(transaction, first, last)
        if first == last:
            return found
        return self._complete(transaction, self._improve(transaction, first, found))

    def _complete(self, transaction: Transaction, found: Search) -> Search:
        """Find all answers, or the best, of the least horizon, where more than any is asked for."""
        if found.satisfiable and (self._models != 1 or transaction.program.optimizes):
            return self._ask(transaction, found.horizon, found.horizon)
        return found

    def _search_grounded(self, transaction: Transaction) -> Search:
        first, horizon = first_horizon(transaction), transaction.state.horizon
        if not self._shortest or first == horizon:
            return self._ask(transaction, horizon, horizon)
        return self._complete(transaction, self._search_range(transaction, first, horizon))

    def _search_range(self, transaction: Transaction, first: int, last: int) -> Search:
        """Find an answer of the least horizon in first..last; the hint and below are asked first."""
        middle = min(max(self._hint, first), last)
        for low, high in ((first, middle - 1), (middle, middle), (middle + 1, last)):
            if low > high:
                continue
            found = self._ask(transaction, low, high)
            if found.satisfiable:
                return self._improve(transaction, low, found)
            if found.satisfiable is None or self.hopeless:
                return found
        return found

    def _improve(self, transaction: Transaction, first: int, best: Search) -> Search:
        """Return an answer of the least horizon, ``best`` where there is none before it."""
        while first < best.horizon:
            found = self._ask(transaction, first, best.horizon - 1)
            if found.satisfiable is None:
                return found
            if not found.satisfiable:
                break
            best = found
        return best

    def _ask(self, transaction: Transaction, first: int, last: int, **limits: Any) -> Search:
        """Ask for the horizons first..last; ``limits`` are further arguments of :meth:`Grounding.search`."""
        if self._halt():
            return Search(None)
        grounding = transaction.ready()
        models = limits.pop("models", self._models if first == last else 1)
        start = time.perf_counter()
        if self._shortest:  # other answers are no plans
            limits["claim"] = transaction.claim_in(grounding)
        found = grounding.search(models, self._halt, first, last, **limits)
        self.seconds += time.perf_counter() - start
        self.permanent = found.satisfiable is False and grounding.conflicting
        self.hopeless = self.permanent or (found.timeless and grounding.complete)
        return found


def first_horizon(transaction: Transaction) -> int:
    """Return the least horizon that an answer may have."""
    return min(transaction.state.settled, transaction.state.horizon)


_TRIAL_STEPS = 3
_KNOWN: "WeakKeyDictionary[ReactiveProgram, bool]" = WeakKeyDictionary()


def may_idle(program: ReactiveProgram, halt: Callable[[], bool]) -> bool:
    """Tell whether the first answer stays one when further steps are grounded; found out once for a program.

    False as well where ``halt`` ended the trial; the next call then makes another one.
    """
    known = _KNOWN.get(program)
    if known is None:
        known = _try(program, halt)
        if known is not None:
            _KNOWN[program] = known
    return bool(known)


def _try(program: ReactiveProgram, halt: Callable[[], bool]) -> Optional[bool]:
    first = program.first_step
    try:
        grounding = Grounding(program, (), set(), shortest=True)
        grounding.ground_to(first)
        found = grounding.search(1, halt, first, first, best=False).satisfiable
        if found:
            grounding.ground_to(first + _TRIAL_STEPS)
            found = grounding.search(1, halt, first, first, best=False).satisfiable
        return found
    except RuntimeError:  # the search itself tells what is wrong
        return False
