"""The search for a plan in limited time: first any plan, preferably the last one, then shorter plans.

A shortest plan requires refuting all shorter horizons, which can take arbitrarily long. A plan with more steps than
necessary is easy to find, in particular if ``#heuristic`` statements guide the search. So the horizon grows if a
question reaches its limit of conflicts. The shortest horizons get a part of the effort, as in Rintanen's algorithms for
planning as satisfiability (2006). The best plan and the refuted horizons then bound the search for shorter plans from
above and below. If the program claims a number of steps, this number and a quarter more are grounded at once.
"""

import time
from typing import Generator, List, Optional, TypeVar

from rosoclingo.planning.history import Plan
from rosoclingo.planning.question import UNKNOWN, Assumptions, Question, Reply, Stop, StoppedError, Strategy
from rosoclingo.planning.strategies.cheaper import cheaper
from rosoclingo.planning.strategies.improve import FEW_STEPS
from rosoclingo.planning.strategies.shortest import SearchResult
from rosoclingo.planning.strategies.trim import trimmed
from rosoclingo.planning.strategy_runner import StrategyRunner

T = TypeVar("T")
_Asks = Generator[Question, Reply, T]

CONFLICTS = 100
"""Initial limit of conflicts for a question.

The limit doubles after a question that reached it. With ``#heuristic`` statements, it does not double before there is a
plan: then only more steps help, since with enough steps there are hardly any conflicts. Because a heuristic can
mislead, the shortest horizons that are not refuted are also tried without it, with limits that double.
"""

EFFORT = 20_000
"""Initial limit of conflicts times steps for a question about any plan, unless :data:`CONFLICTS` allows more.

Conflicts with few steps are cheap, and additional steps make all later questions more expensive.
"""

CONFLICTS_PER_STEP = 100
"""Limit of conflicts per step for a question about any plan, if the program has no ``#heuristic`` statements.

With a lower limit, the horizon grows far beyond the length of a plan before any search finishes.
"""

LEAST_CONFLICTS = 1000
"""Limit of conflicts for a question about the least horizon that is not refuted."""

KEPT = 0.1
"""Fraction of the time limit for shorter plans if the last plan is still valid, or if actions go on: no robot waits."""


class TimeLimitedSearch:
    """The search for a plan after one update."""

    def __init__(
        self, runner: StrategyRunner, models: int, plan: Optional[Plan], seconds: float, succeeds: bool = False
    ) -> None:
        """Prepare the search.

        After the time limit, the result is the best plan so far, or else the first plan found. If further steps can
        invalidate an answer, each horizon is decided before the next one.

        Args:
            runner: the runner of the strategy, which has the snapshot and its grounding.
            models: the number of answers to compute, 0 for all.
            plan: the last plan.
            seconds: the time limit in processor time of this process, so that other processes do not affect plans.
            succeeds: whether the update only reports success; the search time for the last plan is spent already.

        """
        self._runner, self._models, self._plan = runner, models, plan
        self._seconds, self._succeeds, self._start = seconds, succeeds, time.process_time()
        self._program, self._idles = runner.program, runner.block > 1
        self._least = runner.min_horizon  # all lower horizons are refuted
        self._claimed: Optional[int] = None  # the least horizon according to the program
        self._best = UNKNOWN
        self._rests: List[Plan] = []  # what remains of the last plan, unchanged and delayed; to be extended to a plan
        self._end = runner.horizon  # the last horizon to search
        self._earlier_ends: List[int] = []
        self._deadline: Optional[Stop] = None  # set as soon as there is a plan

    def run(self) -> Strategy[SearchResult]:
        """Search until there is a plan, and for shorter plans until the time limit."""
        answered = None
        try:
            yield from self._keep_plan()
            if not self._best.satisfiable:
                reply = yield from self._find()
                if not reply.satisfiable:
                    return SearchResult(reply)
            answered, self._deadline = time.process_time(), self._is_late
            yield from self._shorten()
            yield from self._finish()
        except StoppedError:
            if not self._best.satisfiable:
                raise
        optimal = self._best.optimal or not self._program.optimizes
        return SearchResult(self._best, optimal and self._least >= self._best.horizon, answered)

    # ---- The last plan -----------------------------------------------------------------------------------------------

    def _keep_plan(self) -> _Asks[None]:
        """Adopt the rest of the last plan if it is still a plan, unchanged or delayed by one step.

        If actions go on, only the further actions of the same robots are delayed.
        """
        if self._plan is None:
            return
        step, running = self._runner.step, self._runner.snapshot.running
        rest = self._plan.rest(step)
        plans = [self._plan.delayed_by(running, step)] if running else [rest, self._plan.rest(step - 1).delayed()]
        self._seconds *= KEPT if running else 1.0  # plans are improved while actions run
        for plan in plans:
            reply = yield from self._ask_exactly(plan)
            if reply.satisfiable:
                if plan is rest:
                    self._seconds *= 0.0 if self._succeeds and not plan.shortest else KEPT
                if plan is rest and self._succeeds:
                    self._best = reply
                else:
                    yield from self._adopt(reply)
                return
        self._rests = [] if running else [plan for plan in plans if plan.actions]

    def _ask_exactly(self, plan: Plan) -> _Asks[Reply]:
        """Ask whether exactly the actions of ``plan`` are a plan."""
        last = max(self._least, plan.horizon)
        if last > self._end:
            if not self._idles or last > self._runner.last(last):
                return UNKNOWN
            more = self._runner.block if self._runner.snapshot.running else 0  # the next update delays the plan again
            self._end = max(last, self._runner.last(last + more))
        self._runner.ground(self._end)
        actions = self._runner.actions(self._runner.step, last + 1)
        if not plan.actions.issubset(actions):
            return Reply(False)
        given = plan.fixing(actions)
        return (yield from self._ask(max(self._least, min(plan.last_cycle, last)), last, CONFLICTS, given))

    # ---- Any plan ----------------------------------------------------------------------------------------------------

    def _find(self) -> _Asks[Reply]:
        """Extend the horizon until there is a plan or the bound is reached."""
        factor = 1
        while True:
            reply = yield from self._ask_for_any(factor)
            if reply.satisfiable is None and self._idles:
                reply = yield from self._ask_for_shortest(factor)
            if reply.satisfiable:
                yield from self._adopt(reply)
                return reply
            refuted = self._least > self._end
            grows = self._runner.may_grow(self._end)
            if reply.hopeless or (refuted and not grows):
                return reply
            factor *= 1 if refuted else 2
            if grows:
                self._earlier_ends.append(self._end)
                self._end = self._next_end(refuted)

    def _ask_for_any(self, factor: int) -> _Asks[Reply]:
        """Ask for a plan up to the current end, preferably one with the remaining actions of the last plan."""
        last, grows, advises = self._end, self._runner.may_grow(self._end), self._program.advises
        for plan in self._rests:
            reply = yield from self._ask(self._least, last, CONFLICTS, [(action, True) for action in plan.actions])
            if reply.satisfiable or reply.hopeless:
                return reply
        if not self._idles or not (grows or advises):
            return (yield from self._ask(self._least, last, None))
        conflicts = self._few_conflicts(last) * (1 if grows else factor)
        return (yield from self._ask(self._least, last, conflicts))

    def _ask_for_shortest(self, factor: int) -> _Asks[Reply]:
        """Ask for the shortest horizons that are not refuted, without ``#heuristic``, which can mislead."""
        reply, advises = UNKNOWN, self._program.advises
        for last in [*self._earlier_ends, self._end] if advises else range(self._least, self._end + 1):
            if last < self._least or (advises and last - self._runner.step >= FEW_STEPS):
                continue
            conflicts = factor * self._few_conflicts(last) if advises else LEAST_CONFLICTS
            reply = yield from self._ask(self._least, last, conflicts, advised=not advises)
            if reply.satisfiable is not False or reply.hopeless:
                break
        return reply

    def _few_conflicts(self, last: int) -> int:
        """Return the initial limit of conflicts for the steps up to ``last``."""
        steps = max(1, last - self._runner.step + 1)
        return max(CONFLICTS, EFFORT // steps if self._program.advises else CONFLICTS_PER_STEP * steps)

    def _next_end(self, refuted: bool) -> int:
        """Return the next end: half of the lookahead later.

        With ``#heuristic`` statements it is only a quarter later, unless the current end was ``refuted``. The first
        call adds at least the steps that the program claims, and a quarter more.
        """
        runner = self._runner
        more = (self._end - runner.step) // (4 if self._program.advises and not refuted else 2)
        last = self._end + (max(runner.block, more) if self._idles else 1)
        if self._claimed is None:
            steps = runner.grounding.claimed_steps() if self._idles else 0
            self._claimed = runner.step + steps - 1
            last = max(last, self._claimed + steps // 4)
        return runner.last(last)

    # ---- Shorter plans -----------------------------------------------------------------------------------------------

    def _shorten(self) -> _Asks[None]:
        """Search for shorter plans and refute the least horizon, in turns, until the bounds meet or time is up."""
        conflicts = CONFLICTS
        claimed = min(self._claimed or 0, self._best.horizon)
        if self._least < claimed and not self._is_late():
            yield from self._try(self._least, claimed - 1, conflicts)
        while self._least < self._best.horizon and not self._is_late():
            first, last = self._least, self._best.horizon - 1
            few = last - self._runner.step < FEW_STEPS
            for advised in (True, False) if self._program.advises and few else (True,):
                if self._best.horizon > last >= self._least:
                    yield from self._try(first, last, conflicts, advised)
            if first < last and self._least == first and self._best.horizon > first:
                yield from self._try(first, first, conflicts)
            if self._least == first and self._best.horizon > last:
                conflicts *= 2

    def _try(self, first: int, last: int, conflicts: int, advised: bool = True) -> _Asks[None]:
        reply = yield from self._ask(first, last, conflicts, advised=advised)
        if reply.satisfiable:
            yield from self._adopt(reply)

    def _adopt(self, reply: Reply) -> _Asks[None]:
        """Trim the plan in ``reply`` and make it the best one."""
        self._best = yield from trimmed(reply, self._runner, self._runner.step - 1, self._least, until=self._deadline)

    def _finish(self) -> _Asks[None]:
        """Compute all answers with the best horizon, or optimize the answer in the remaining time."""
        last = self._best.horizon
        if self._models != 1:
            reply = yield Question(last, last, models=self._models, best=True)
            self._best = reply if reply.satisfiable else self._best
        elif self._program.optimizes:
            self._best = yield from cheaper(self._best, self._runner, self._runner.step, (), None, self._deadline)

    # ---- Questions ---------------------------------------------------------------------------------------------------

    def _is_late(self) -> bool:
        """Return whether to accept the best plan so far."""
        return time.process_time() - self._start >= self._seconds

    def _ask(
        self, first: int, last: int, conflicts: Optional[int], given: Optional[Assumptions] = None, advised: bool = True
    ) -> _Asks[Reply]:
        """Ask for any answer; if there are no assumptions ``given``, record the refuted horizons."""
        reply = yield Question(first, last, given or (), conflicts=conflicts, advised=advised, until=self._deadline)
        if reply.satisfiable is False and given is None and first <= self._least:
            self._least = max(self._least, last + 1)
        return reply
