"""The search for a plan soon: any plan first, the last one where it still is one, then shorter ones while time lasts.

The shortest plan is found by refuting every shorter horizon, which may take for ever. A plan of some horizon is found
soon: with more steps than are needed it is easy, the more so where ``#heuristic`` says what to do next. So the horizon
grows by a quarter as long as a few conflicts do not tell (as in Rintanen's algorithms for planning as satisfiability,
2006), by a half where it is refuted, and what is found bounds the horizons to look at from above, as what is refuted
does from below. Where the program claims that so many steps are needed, as many and a quarter more are ground at once.
"""

import time
from typing import Callable, Generator, List, Optional, TypeVar

from rosoclingo.planning.asking import Asking
from rosoclingo.planning.history import Plan
from rosoclingo.planning.question import UNKNOWN, Given, Question, Reply, Stop, StoppedError, Strategy
from rosoclingo.planning.strategies.improve import FEW_STEPS
from rosoclingo.planning.strategies.shortest import SearchResult
from rosoclingo.planning.strategies.trim import trimmed

T = TypeVar("T")
_Asks = Generator[Question, Reply, T]

Clock = Callable[[], float]
"""Seconds of processor time that this process has used: a loaded machine leaves the plans as they are."""

CLOCK: Clock = time.process_time

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
"""Part of the time that is given to prove once more that a plan that went on as predicted is the shortest."""


class TimeLimit:
    """The time for one update: ``seconds`` of ``clock`` from now on.

    Where the update is ``predicted``, as it tells nothing but that things went as planned, a plan that can be kept has
    had its time before.

    Attributes:
        predicted: whether the update is such.

    """

    def __init__(self, seconds: float, predicted: bool = False, clock: Clock = CLOCK) -> None:
        self._seconds, self.predicted, self._clock = seconds, predicted, clock
        self._begin = clock()

    def plan_is_kept(self, shortest: bool) -> None:
        """Note that the last plan, proven to be the ``shortest`` or not, still is one."""
        if self.predicted:
            self._seconds *= PROOF_AGAIN if shortest else 0.0

    def is_over(self) -> bool:
        """Whether a plan that is known has to do."""
        return self._clock() - self._begin >= self._seconds


class Soon:
    """One update's search for a plan soon."""

    def __init__(self, asking: Asking, models: int, plan: Optional[Plan], time_limit: "TimeLimit") -> None:
        """Prepare to search for ``models`` answers; ``plan`` is the last one.

        If an answer may not outlive further steps, each horizon is decided before the next. When the time is over the
        best plan that is known is the answer; if none is, the search goes on.
        """
        self._asking, self._models, self._plan, self._time = asking, models, plan, time_limit
        self._program, self._idles = asking.program, asking.block > 1
        self._least = asking.first  # no answer has a horizon below it
        self._claimed: Optional[int] = None  # nor below this one, if it is true what the program claims
        self._best: Optional[Reply] = None
        self._old: List[Plan] = []  # what may be left of the last plan
        self._end = asking.horizon  # the horizon up to which a plan is looked for
        self._tried: List[int] = []  # those before it
        self._deadline: Optional[Stop] = None  # once there is a plan

    def run(self) -> Strategy[SearchResult]:
        """Search until there is a plan, and for a shorter one in the time that is left."""
        answered = None
        try:
            if (yield from self._keep()):
                self._time.plan_is_kept(self._plan is not None and self._plan.shortest)
            reply = self._best or (yield from self._find())
            if self._best is None:
                return SearchResult(reply)
            answered, self._deadline = time.process_time(), self._time.is_over
            yield from self._shorten()
            yield from self._choose()
        except StoppedError:
            if self._best is None:
                raise
        return SearchResult(self._best, self._least >= self._best.horizon, answered)

    # ---- The last plan -----------------------------------------------------------------------------------------------

    def _keep(self) -> _Asks[bool]:
        """Take the rest of the last plan, as it is or one step later, for the best if it is a plan; tell whether."""
        if self._plan is None:
            return False
        rest = self._plan.since(self._asking.step)
        later = self._plan.since(self._asking.step - 1).later()
        for plan in (rest, later):
            found = yield from self._exactly(plan)
            if found.satisfiable:
                if plan is rest and self._time.predicted:
                    self._best = found
                else:
                    yield from self._take(found)
                return plan is rest
        self._old = [plan for plan in (rest, later) if plan.actions]
        return False

    def _exactly(self, plan: Plan) -> _Asks[Reply]:
        """Ask whether to do what ``plan`` says, and nothing else, is a plan."""
        last = max(self._least, plan.horizon)
        if last > self._end:
            if not self._idles or last > self._asking.last(last):
                return UNKNOWN
            self._end = last
        actions = self._asking.actions(self._asking.step, last + 1, self._end)
        if not plan.actions.issubset(actions):
            return Reply(False)
        given = [(action, action in plan.actions) for action in actions]
        return (yield from self._look(max(self._least, min(plan.last_cycle, last)), last, CONFLICTS, given))

    # ---- Any plan ----------------------------------------------------------------------------------------------------

    def _find(self) -> _Asks[Reply]:
        """Let the horizon grow until there is a plan or no more may be ground."""
        harder = 1
        while True:
            found = yield from self._any(harder)
            if found.satisfiable is None and self._program.advises and self._idles:
                found = yield from self._unadvised(harder)
            if found.satisfiable:
                yield from self._take(found)
                return found
            refuted = self._least > self._end
            if found.hopeless or (not self._may_grow and refuted):
                return found
            harder *= 1 if refuted else 2
            if self._may_grow:
                self._tried.append(self._end)
                self._end = self._next_end(refuted)

    def _any(self, harder: int) -> _Asks[Reply]:
        """Ask for a plan within what is ground: first one that goes on from an old one."""
        last, more, advises = self._end, self._may_grow, self._program.advises
        for plan in self._old:
            found = yield from self._look(self._least, last, CONFLICTS, [(one, True) for one in plan.actions])
            if found.satisfiable or found.hopeless:
                return found
        if not self._idles or not (more or advises):
            return (yield from self._look(self._least, last, None))
        conflicts = self._few(last) * (1 if advises and more else harder)
        return (yield from self._look(self._least, last, conflicts))

    def _unadvised(self, harder: int) -> _Asks[Reply]:
        """Ask for a plan of the least steps, if few, that are not refuted, without advice, which may mislead."""
        found = UNKNOWN
        for last in [*self._tried, self._end]:
            if last >= self._least and last - self._asking.step < FEW_STEPS:
                found = yield from self._look(self._least, last, harder * self._few(last), advised=False)
                if found.satisfiable is not False or found.hopeless:
                    break
        return found

    def _few(self, last: int) -> int:
        """Return how many conflicts are few for steps up to ``last``."""
        return max(CONFLICTS, EFFORT // max(1, last - self._asking.step + 1))

    @property
    def _may_grow(self) -> bool:
        """Whether bound and limit allow another step."""
        return self._asking.last(self._end + 1) > self._end

    def _next_end(self, refuted: bool) -> int:
        """Return a quarter more of the steps to come, half as many more if all are ``refuted``.

        At first, as many as the program claims that a plan takes, and a quarter more, if these are more.
        """
        asking = self._asking
        more = (self._end - asking.step) // (2 if refuted else 4)
        last = self._end + (max(asking.block, more) if self._idles else 1)
        if self._claimed is None:
            steps = asking.claimed_steps() if self._idles else 0
            self._claimed = asking.step + steps - 1
            last = max(last, self._claimed + steps // 4)
        return asking.last(last)

    # ---- A shorter one -----------------------------------------------------------------------------------------------

    def _shorten(self) -> _Asks[None]:
        """Look for shorter plans, and refute the least horizons in turns, until both meet or the time is over."""
        conflicts = CONFLICTS
        if self._best is not None and not self._time.is_over():
            claimed = min(self._claimed or 0, self._best.horizon)
            if self._least < claimed:
                yield from self._try(self._least, claimed - 1, conflicts)
        while self._best is not None and self._least < self._best.horizon and not self._time.is_over():
            first, last = self._least, self._best.horizon - 1
            few = last - self._asking.step < FEW_STEPS
            for advised in (True, False) if self._program.advises and few else (True,):
                if self._best.horizon > last >= self._least:
                    yield from self._try(first, last, conflicts, advised)
            if first < last and self._least == first and self._best.horizon > first:
                yield from self._try(first, first, conflicts)
            if self._least == first and self._best.horizon > last:
                conflicts *= 2

    def _try(self, first: int, last: int, conflicts: int, advised: bool = True) -> _Asks[None]:
        found = yield from self._look(first, last, conflicts, advised=advised)
        if found.satisfiable:
            yield from self._take(found)

    def _take(self, found: Reply) -> _Asks[None]:
        """Adopt ``found``, without superfluous actions and idle steps, as the best plan."""
        self._best = yield from trimmed(found, self._asking, self._asking.step - 1, self._least, until=self._deadline)

    def _choose(self) -> _Asks[None]:
        """Find all answers of the plan's horizon, or a better one in the time that is left."""
        assert self._best is not None
        one, last = self._models == 1, self._best.horizon
        if one and not self._program.optimizes:
            return
        until = self._deadline if one else None
        found = yield Question(last, last, models=self._models, best=True, proven=not one, until=until)
        if found.satisfiable:
            self._best = found

    # ---- Questions ---------------------------------------------------------------------------------------------------

    def _look(
        self, first: int, last: int, conflicts: Optional[int], given: Optional[Given] = None, advised: bool = True
    ) -> _Asks[Reply]:
        """Ask for any answer; what is refuted without anything ``given`` need never be asked again."""
        found = yield Question(first, last, given or (), conflicts=conflicts, advised=advised, until=self._deadline)
        if found.satisfiable is False and given is None and first <= self._least:
            self._least = max(self._least, last + 1)
        return found
