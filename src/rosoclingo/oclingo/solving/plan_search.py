"""The search for a plan soon: any plan first, the last one where it still is one, then shorter ones while time lasts.

The shortest plan is found by refuting every shorter horizon, which may take for ever. A plan of some horizon is found
soon: with more steps than are needed it is easy, the more so where ``#heuristic`` says what to do next. So the horizon
grows by a quarter as long as a few conflicts do not tell (as in Rintanen's algorithms for planning as satisfiability,
2006), by a half where it is refuted, and what is found bounds the horizons to look at from above, as what is refuted
does from below. Where the program claims that so many steps are needed, as many and a quarter more are ground at once.
"""

import math
import time
from typing import Callable, Iterator, List, Optional, Tuple

import clingo

from rosoclingo.oclingo.solving.assumptions import Search
from rosoclingo.oclingo.solving.horizon_search import HorizonSearch, first_horizon
from rosoclingo.oclingo.solving.improvement import FEW_STEPS
from rosoclingo.oclingo.solving.stream_log import Plan
from rosoclingo.oclingo.solving.transaction import Transaction
from rosoclingo.oclingo.solving.trimming import Given, trimmed

Clock = Callable[[], float]
"""Seconds of processor time that this process has used: a loaded machine leaves the plans as they are."""

CLOCK: Clock = time.process_time

PIECE_ATOMS = 250_000
"""About so many atoms are grounded between two looks at the stop request: each call goes through all there are."""

PIECE = 64
"""So many steps at least, nearly: what is to come is parted evenly."""

CONFLICTS = 100
"""Conflicts that a question may take, at first.

Where one was not enough the next may take twice as many; but while there is no plan and ``#heuristic`` guides the
search, only more steps help: with enough of them there are next to no conflicts. Unless it misleads: so the least steps
that are not refuted are tried without it, too, ever harder.
"""

EFFORT = 20_000
"""Conflicts times steps that a question for any plan may take, at first, if that is more.

A conflict among few steps is cheap, and more steps make all that follows dearer.
"""

PROOF_AGAIN = 0.1
"""Part of the time that is given to prove once more that a plan that went on as foreseen is the shortest."""


class TimeLimit:
    """The time for one update: ``seconds`` of ``clock`` from now on.

    Where the update is ``foreseen``, as it tells nothing but that things went as planned, a plan that can be kept has
    had its time before.

    Attributes:
        foreseen: whether the update is such.

    """

    def __init__(self, seconds: float, foreseen: bool = False, clock: Clock = CLOCK) -> None:
        self._seconds, self.foreseen, self._clock = seconds, foreseen, clock
        self._begin = clock()

    def plan_is_kept(self, shortest: bool) -> None:
        """Note that the last plan, proven to be the ``shortest`` or not, still is one."""
        if self.foreseen:
            self._seconds *= PROOF_AGAIN if shortest else 0.0

    def is_over(self) -> bool:
        """Whether a plan that is known has to do."""
        return self._clock() - self._begin >= self._seconds


class PlanSearch(HorizonSearch):
    """One update's search for a plan soon."""

    def __init__(
        self, models: int, plan: Optional[Plan], block: int, halt: Callable[[], bool], time_limit: "TimeLimit"
    ) -> None:
        """Prepare to search for ``models`` answers.

        ``plan`` is the last one, ``block`` the number of steps to grow by at least; where it is 1 an answer may not
        outlive further steps, and each horizon is decided before the next. When the time is over the best plan that is
        known is the answer; where none is, the search goes on.
        """
        super().__init__(models, True, 0, block, halt)
        self._caller_halts, self._plan, self._time = halt, plan, time_limit
        self._least = 0  # no answer has a horizon below it
        self._claimed: Optional[int] = None  # nor below this one, if it is true what the program claims
        self._best: Optional[Search] = None
        self._old: List[Plan] = []  # what may be left of the last plan
        self._ends: List[int] = []  # horizons up to which was looked for a plan, before there were more

    def run(self, transaction: Transaction) -> Search:
        """Search until there is a plan, and for a shorter one in the time that is left."""
        self._least = first_horizon(transaction)
        if self._keep(transaction):
            self._time.plan_is_kept(self._plan is not None and self._plan.shortest)
        found = self._best or self._find(transaction)
        if self._best is None:
            return found
        self.answered = time.process_time()
        self._halt = self._is_over
        self._shorten(transaction)
        self.proven = self._least >= self._best.horizon
        return self._all(transaction, self._best)

    # ---- The last plan -----------------------------------------------------------------------------------------------

    def _keep(self, transaction: Transaction) -> bool:
        """Take the rest of the last plan, as it is or one step later, for the best where it is a plan; tell whether."""
        if self._plan is None:
            return False
        step = transaction.state.step
        rest = self._plan.since(step)
        later = self._plan.since(step - 1).later()
        for plan in (rest, later):
            found = self._exactly(transaction, plan)
            if found.satisfiable:
                if plan is rest and self._time.foreseen:
                    self._best = found
                else:
                    self._take(transaction, found)
                return plan is rest
        self._old = [plan for plan in (rest, later) if plan.actions]
        return False

    def _exactly(self, transaction: Transaction, plan: Plan) -> Search:
        """Ask whether to do what ``plan`` says, and nothing else, is a plan."""
        last = max(self._least, plan.horizon)
        if last > transaction.state.horizon:
            if self._block == 1 or last > transaction.last_horizon(last):
                return Search(None)
            transaction.grow_to(last)
        actions = transaction.ready().actions(transaction.state.step, last + 1)
        if not plan.actions.issubset(actions):
            return Search(False)
        given = [(action, action in plan.actions) for action in actions]
        return self._look(transaction, max(self._least, min(plan.last_cycle, last)), last, CONFLICTS, given)

    # ---- Any plan ----------------------------------------------------------------------------------------------------

    def _find(self, transaction: Transaction) -> Search:
        """Let the horizon grow until there is a plan or no more may be grounded."""
        harder = 1
        while True:
            found = self._any(transaction, harder)
            if found.satisfiable is None and transaction.program.advises and self._block > 1:
                found = self._unadvised(transaction, harder)
            if found.satisfiable:
                self._take(transaction, found)
                return found
            more, refuted = transaction.may_grow(), self._least > transaction.state.horizon
            if self.hopeless or (not more and (refuted or self._caller_halts())):
                return found
            harder *= 1 if refuted else 2
            for _ in self._grow(transaction, refuted) if more else ():
                if self._caller_halts():
                    return Search(None)

    def _any(self, transaction: Transaction, harder: int) -> Search:
        """Ask for a plan within what is grounded: first one that goes on from an old one."""
        last, more, advises = transaction.state.horizon, transaction.may_grow(), transaction.program.advises
        for plan in self._old:
            found = self._look(transaction, self._least, last, CONFLICTS, [(one, True) for one in plan.actions])
            if found.satisfiable or self.hopeless:
                return found
        if self._block == 1 or not (more or advises):
            return self._look(transaction, self._least, last, None)
        conflicts = self._few(transaction, last) * (1 if advises and more else harder)
        return self._look(transaction, self._least, last, conflicts)

    def _unadvised(self, transaction: Transaction, harder: int) -> Search:
        """Ask for a plan of the least steps, if few, that are not refuted, without advice, which may mislead."""
        found = Search(None)
        for last in [*self._ends, transaction.state.horizon]:
            if last >= self._least and last - transaction.state.step < FEW_STEPS:
                conflicts = harder * self._few(transaction, last)
                found = self._look(transaction, self._least, last, conflicts, advised=False)
                if found.satisfiable is not False or self.hopeless:
                    break
        return found

    def _few(self, transaction: Transaction, last: int) -> int:
        """Return how many conflicts are few for steps up to ``last``."""
        return max(CONFLICTS, EFFORT // max(1, last - transaction.state.step + 1))

    def _grow(self, transaction: Transaction, refuted: bool) -> Iterator[None]:
        """Ground a quarter more of the steps to come, half as many more where all are ``refuted``, piece by piece.

        At first, as many as the program claims that a plan takes, and a quarter more, if these are more.
        """
        state = transaction.state
        self._ends.append(state.horizon)
        more = (state.horizon - state.step) // (2 if refuted else 4)
        last = state.horizon + (max(self._block, more) if self._block > 1 else 1)
        if self._claimed is None:
            steps = transaction.ready().claimed_steps(state.step) if self._block > 1 else 0
            self._claimed = state.step + steps - 1
            last = max(last, self._claimed + steps // 4)
        last = transaction.last_horizon(last)
        while state.horizon < last:
            yield
            rest = last - state.horizon
            pieces = round(rest / max(PIECE, PIECE_ATOMS // transaction.ready().atoms_per_step))
            transaction.grow_to(state.horizon + math.ceil(rest / max(1, pieces)))

    # ---- A shorter one -----------------------------------------------------------------------------------------------

    def _shorten(self, transaction: Transaction) -> None:
        """Look for shorter plans, and refute the least horizons in turns, until both meet or the time is over."""
        conflicts = CONFLICTS
        if self._best is not None and not self._is_over():
            claimed = min(self._claimed or 0, self._best.horizon)
            if self._least < claimed:
                self._try(transaction, self._least, claimed - 1, conflicts)
        while self._best is not None and self._least < self._best.horizon and not self._is_over():
            first, last = self._least, self._best.horizon - 1
            few = last - transaction.state.step < FEW_STEPS
            for advised in (True, False) if transaction.program.advises and few else (True,):
                if self._best.horizon > last >= self._least:
                    self._try(transaction, first, last, conflicts, advised)
            if first < last and self._least == first and self._best.horizon > first:
                self._try(transaction, first, first, conflicts)
            if self._least == first and self._best.horizon > last:
                conflicts *= 2

    def _try(self, transaction: Transaction, first: int, last: int, conflicts: int, advised: bool = True) -> None:
        found = self._look(transaction, first, last, conflicts, advised=advised)
        if found.satisfiable:
            self._take(transaction, found)

    def _take(self, transaction: Transaction, found: Search) -> None:
        """Adopt ``found``, without superfluous actions and idle steps, as the best plan."""

        def ask(first: int, last: int, given: Given, conflicts: int) -> Search:
            """Ask for a part of the plan."""
            return self._look(transaction, first, last, conflicts, given)

        self._best = trimmed(found, transaction.state.step - 1, self._least, transaction.ready(), ask)
        self.hopeless = self.permanent = False  # answers about parts of a plan hold for no other plans

    def _all(self, transaction: Transaction, best: Search) -> Search:
        """Find all answers of the plan's horizon, or a better one in the time that is left."""
        one = self._models == 1
        if one and not transaction.program.optimizes:
            return best
        self._halt = self._is_over if one else self._caller_halts
        found = self._ask(transaction, best.horizon, best.horizon, proven=not one)
        return found if found.satisfiable else best

    # ---- Questions ---------------------------------------------------------------------------------------------------

    def _look(
        self,
        transaction: Transaction,
        first: int,
        last: int,
        conflicts: Optional[int],
        given: Optional[List[Tuple[clingo.Symbol, bool]]] = None,
        advised: bool = True,
    ) -> Search:
        """Ask for any answer; what is refuted without anything ``given`` need never be asked again."""
        limits = {"conflicts": conflicts, "given": given or (), "advised": advised}
        found = self._ask(transaction, first, last, models=1, best=False, **limits)
        if found.satisfiable is False and given is None and first <= self._least:
            self._least = max(self._least, last + 1)
        return found

    def _is_over(self) -> bool:
        """Whether a plan that is known has to do."""
        return self._caller_halts() or self._time.is_over()
