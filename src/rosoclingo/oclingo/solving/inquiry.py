"""What would be, had some facts not been told: asked of one grounding, in which these facts are in doubt.

Each question is a search under assumptions, so a question without an answer has a core: a few of the facts because of
which there is none (see clingo's ``SolveHandle.core``). Every other question that agrees on these has no answer either.
"""

from dataclasses import replace
from typing import Callable, FrozenSet, Iterator, List, NamedTuple, Optional, Sequence, Set

import clingo

from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.assumptions import Search
from rosoclingo.oclingo.solving.horizon_search import first_horizon
from rosoclingo.oclingo.solving.stream_state import Setting, StreamState
from rosoclingo.oclingo.solving.transaction import Transaction

PIECE = 32
"""Steps that are grounded between two looks at the stop request, and at least before the next question."""


class Verdict(NamedTuple):
    """Whether there is an answer, None where that was not found out before a stop.

    Where there is none, ``core`` holds facts in doubt: it is so whenever these are told or untold as they were.
    """

    satisfiable: Optional[bool]
    core: FrozenSet[clingo.Symbol] = frozenset()


class Inquiry:
    """Questions about one ``update`` after one ``state``, in which all facts ``doubted`` were told.

    Where ``idles`` tells that an answer stays one when further steps are ground, the program is ground once, else anew
    for each question. For ``shortest`` solvers.
    """

    def __init__(
        self,
        setting: Setting,
        state: StreamState,
        update: StreamUpdate,
        doubted: FrozenSet[clingo.Symbol],
        idles: bool,
    ) -> None:
        self._setting, self._state, self._update, self._doubted = setting, state, update, doubted
        self._idles = idles
        self._transaction: Optional[Transaction] = None
        self._least = 0  # the horizon up to which is searched whatever the bound

    def is_about(self, state: StreamState, update: StreamUpdate, doubted: FrozenSet[clingo.Symbol]) -> bool:
        """Whether it can tell of these; the update's bound belongs to a question."""
        return self._state is state and self._update == replace(update, bound=None) and self._doubted == doubted

    def ask(
        self,
        untold: FrozenSet[clingo.Symbol],
        bound: Optional[int],
        halt: Callable[[], bool],
        dropped: Optional[Callable[[], bool]] = None,
    ) -> Verdict:
        """Tell whether there is an answer of at most ``bound`` steps, had the facts ``untold`` not been told.

        Raises DroppedError and RuntimeError as a grounding made anew does.
        """
        found = self.search(untold, bound, halt, dropped, believes=True)
        return Verdict(found.satisfiable, found.core)

    def search(
        self,
        untold: FrozenSet[clingo.Symbol],
        bound: Optional[int],
        halt: Callable[[], bool],
        dropped: Optional[Callable[[], bool]] = None,
        kept: Sequence[clingo.Symbol] = (),
        believes: bool = False,
    ) -> Search:
        """Look for an answer as :meth:`ask` does, in which the atoms ``kept`` are true, those of them that are ground.

        Where it ``believes`` the program it looks for none if that claims that there is none; but who wants to know
        why there is none does not.

        The longest horizon that may do is asked for last: with more steps it is easier to find an answer, but all of
        them have to be ground where there is none, unless the reason for that has nothing to do with the horizon.
        """
        transaction = self._begun(halt, dropped)
        if transaction is None:
            return Search(None)
        state = transaction.state
        state.bound = None if bound is None else state.step + bound
        core: Set[clingo.Symbol] = set()
        blamed: Set[clingo.Symbol] = set()
        for last in self._horizons(transaction, halt):
            if halt():
                return Search(None)
            grounding = transaction.ready()
            first, claim = first_horizon(transaction), transaction.claim_in(grounding) if believes else None
            found = grounding.search(1, halt, first, last, best=False, untold=untold, kept=kept, claim=claim)
            if found.satisfiable is not False:
                return found
            core = set(found.core) if self._idles else core | found.core
            blamed = set(found.blamed) if self._idles else blamed | found.blamed
            if grounding.conflicting:
                return Search(False, timeless=True)
            timeless = found.timeless and grounding.complete
            if last == self._end(transaction) or timeless:
                return Search(False, core=frozenset(core), timeless=timeless, blamed=frozenset(blamed))
        return Search(None)

    def known(self) -> List[clingo.Symbol]:
        """Return all atoms that may be true at the steps that have been ground for the last question."""
        grounding = None if self._transaction is None else self._transaction.grounding
        return [] if grounding is None else grounding.known

    def _begun(self, halt: Callable[[], bool], dropped: Optional[Callable[[], bool]]) -> Optional[Transaction]:
        """Return the transaction that has taken the update; None where it was stopped."""
        if self._transaction is None or not self._idles:
            begun = Transaction(self._setting, self._state.shortened(), None, dropped, doubted=self._doubted)
            if not begun.begin(self._update, halt):
                return None
            self._transaction, self._least = begun, max(self._state.horizon, begun.state.horizon)
        return self._transaction

    def _horizons(self, transaction: Transaction, halt: Callable[[], bool]) -> Iterator[int]:
        """Yield the horizons up to which to search: what is ground, then twice as many steps; ends on a stop."""
        state, end = transaction.state, self._end(transaction)
        yield min(state.horizon, end)
        while state.horizon < end:
            steps = state.horizon - first_horizon(transaction) + 1
            last = min(end, state.horizon + (max(steps, PIECE) if self._idles else 1))
            while state.horizon < last:
                if halt():
                    return
                _grow(transaction, min(last, state.horizon + PIECE))
            yield last

    def _end(self, transaction: Transaction) -> int:
        """Return the longest horizon that may do."""
        return max(self._least, transaction.last_horizon())


def _grow(transaction: Transaction, last: int) -> None:
    """Ground up to ``last``.

    A rule that defines the same atom at each step is of no harm where that is a fact. It may not be one where facts are
    in doubt; and clingo takes such rules only together, before any search: then the program is ground anew.
    """
    try:
        transaction.grow_to(last)
    except RuntimeError:
        transaction.grounding = None  # a fault of another kind will show again
