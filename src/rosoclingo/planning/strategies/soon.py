"""The search for any plan, preferably the last one; improve.py shortens it.

A shortest plan requires refuting all shorter horizons, which can take arbitrarily long. A plan with more steps than
necessary is easy to find, in particular if ``#heuristic`` statements guide the search. So the horizon grows if a
question reaches its limit of conflicts. The shortest horizons get a part of the effort, as in Rintanen's algorithms for
planning as satisfiability (2006). If the program claims a number of steps, this number and a quarter more are grounded
at once.
"""

from typing import Generator, List, NamedTuple, Optional, TypeVar

from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.question import UNKNOWN, Assumptions, Question, Reply, Strategy
from rosoclingo.planning.strategies.improve import FEW_STEPS
from rosoclingo.planning.strategies.keep_order import beginnings, rescheduled
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

EFFORT = 800_000
"""Initial limit of conflicts times possible actions for a question about any plan, at least :data:`CONFLICTS`.

Each conflict takes longer if there are more actions, and additional steps make all later questions more expensive.
"""

CONFLICTS_PER_STEP = 100
"""Limit of conflicts per step for a question about any plan, if the program has no ``#heuristic`` statements.

With a lower limit, the horizon grows far beyond the length of a plan before any search finishes.
"""

LEAST_CONFLICTS = 1000
"""Limit of conflicts for a question about the least horizon that is not refuted."""

LATER = 2
"""Number of steps by which actions of the last plan can be late, so that another one begins."""

KEPT = 0.1
"""Fraction of the time limit for shorter plans if the last plan is still valid, or if actions go on: no robot waits."""


class FirstPlan(NamedTuple):
    """The result of a search for any plan.

    Attributes:
        reply: the last reply, with the plan if there is one.
        least: the least horizon that is not refuted.
        share: the fraction of the time limit that is worth spending on a better plan.

    """

    reply: Reply
    least: int = 0
    share: float = 0.0


class FirstPlanSearch:
    """The search for any plan after one update."""

    def __init__(self, runner: StrategyRunner, plan: Optional[Plan], succeeds: bool = False) -> None:
        """Prepare the search.

        If further steps can invalidate an answer, each horizon is decided before the next one.

        Args:
            runner: the runner of the strategy, which has the snapshot and its grounding.
            plan: the last plan.
            succeeds: whether the update only reports success; time was spent on improving the last plan already.

        """
        self._runner, self._plan, self._succeeds = runner, plan, succeeds
        self._program, self._idles = runner.program, runner.block > 1
        self._least = runner.min_horizon  # all lower horizons are refuted
        self._share = 1.0
        self._claimed: Optional[int] = None  # the least horizon according to the program
        self._rests: List[Plan] = []  # the rest of the last plan, unchanged and delayed; to be extended to a plan
        self._end = runner.horizon  # the last horizon to search
        self._earlier_ends: List[int] = []

    def run(self) -> Strategy[FirstPlan]:
        """Search until there is a plan, or no plan up to the bound."""
        reply = yield from self._keep_plan()
        if reply is None:
            reply = yield from self._find()
        return FirstPlan(reply, self._least, self._share)

    # ---- The last plan -----------------------------------------------------------------------------------------------

    def _keep_plan(self) -> _Asks[Optional[Reply]]:
        """Return the rest of the last plan if it is still a plan, unchanged or delayed; otherwise None.

        If actions go on, the others keep their order, see keep_order.py. If this is no plan, all of them are delayed.
        If no action begins then, robots that wait begin theirs if they can: the running actions can hang.
        """
        if self._plan is None:
            return None
        step, running = self._runner.step, self._runner.snapshot.running
        rest = self._plan.rest(step)
        plans = [rest, self._plan.rest(step - 1).delayed()]
        if running:
            plans = [rescheduled(self._plan, running, step), self._plan.waiting_for(running, step)]
        self._share *= KEPT if running else 1.0  # plans are improved while actions run
        for plan in plans:
            reply = yield from self._ask_exactly(plan)
            if reply.satisfiable:
                if plan is rest:
                    self._share *= 0.0 if self._succeeds and not plan.shortest else KEPT
                if running:  # plans are trimmed while actions run
                    return (yield from self._with_beginnings(reply))
                if plan is rest and self._succeeds:
                    return reply
                return (yield from self._trimmed(reply))
        self._rests = [plan for plan in plans if plan.actions]
        return None

    def _with_beginnings(self, reply: Reply) -> _Asks[Reply]:
        """Return ``reply``, or if no action begins in it, a plan that begins the next ones of robots that wait."""
        step, last = self._runner.step, reply.plan.horizon
        actions = self._runner.actions(step, last)
        nexts = beginnings(reply.plan, self._runner.snapshot.running, step)
        for begun in [one for one in nexts if one in actions]:
            fixed = [(one, True) for one in (begun, *reply.plan.actions) if cycle_of(one) == step]
            others = [given for given in reply.plan.excluding_others(actions, LATER) if given[0] != begun]
            found = yield from self._ask(self._least, last, CONFLICTS, [*fixed, *others])
            reply = found if found.satisfiable else reply
        return reply

    def _reach(self, last: int) -> bool:
        """Ground the steps up to ``last``; return whether that is possible."""
        if last > self._end:
            if not self._idles or last > self._runner.last(last):
                return False
            more = self._runner.block if self._runner.snapshot.running else 0  # the next update delays the plan again
            self._end = max(last, self._runner.last(last + more))
        self._runner.ground(self._end)
        return True

    def _ask_exactly(self, plan: Plan) -> _Asks[Reply]:
        """Ask whether exactly the actions of ``plan`` are a plan."""
        last = max(self._least, plan.horizon)
        if not self._reach(last):
            return UNKNOWN
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
                return (yield from self._trimmed(reply))
            refuted = self._least > self._end
            grows = self._runner.may_grow(self._end)
            if reply.hopeless or (refuted and not grows):
                return reply
            factor *= 1 if refuted else 2
            if grows:
                self._earlier_ends.append(self._end)
                self._end = self._next_end(refuted)

    def _ask_for_any(self, factor: int) -> _Asks[Reply]:
        """Ask for a plan up to the current end: first with the rest of the last plan, then for any other.

        While actions go on, a program with advice is first asked for any plan, so that robots share new tasks.
        """
        reply, advised = UNKNOWN, bool(self._runner.snapshot.running) and self._program.advises
        if advised:
            reply = yield from self._ask_freely(factor)
        for plan in () if reply.satisfiable or reply.hopeless else self._rests:
            given = [(action, True) for action in plan.actions]
            extended = yield from self._ask(self._least, self._end, CONFLICTS, given)
            if extended.satisfiable or extended.hopeless:
                return extended
        return reply if advised else (yield from self._ask_freely(factor))

    def _ask_freely(self, factor: int) -> _Asks[Reply]:
        """Ask for a plan up to the current end with any actions."""
        last, grows, advises = self._end, self._runner.may_grow(self._end), self._program.advises
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
        if not self._program.advises:
            return max(CONFLICTS, CONFLICTS_PER_STEP * (last - self._runner.step + 1))
        self._runner.ground(last)
        return max(CONFLICTS, EFFORT // max(1, len(self._runner.actions(self._runner.step, last))))

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

    # ---- Questions ---------------------------------------------------------------------------------------------------

    def _trimmed(self, reply: Reply) -> _Asks[Reply]:
        return (yield from trimmed(reply, self._runner, self._runner.step - 1, self._least))

    def _ask(
        self, first: int, last: int, conflicts: Optional[int], given: Optional[Assumptions] = None, advised: bool = True
    ) -> _Asks[Reply]:
        """Ask for any answer; if there are no assumptions ``given``, record the refuted horizons."""
        reply = yield Question(first, last, given or (), conflicts=conflicts, advised=advised)
        if reply.satisfiable is False and given is None and first <= self._least:
            self._least = max(self._least, last + 1)
        return reply
