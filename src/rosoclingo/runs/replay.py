"""A recorded run solved again: for each cycle, whether what was decided is what would be decided now, and if not why.

A decision is right if it is a plan of the program, and actions went out as it says. Another plan as short is no
difference; a longer one is explained where the core took the best that it knew in time.
"""

import time
from dataclasses import dataclass, replace
from enum import Enum
from typing import Callable, Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from clingo import Symbol

from rosoclingo.oclingo import (
    Answer,
    Literal,
    OclingoError,
    ReactiveProgram,
    SolveOutcome,
    SolverError,
    SolveResult,
    Statement,
    StreamUpdate,
    Volatile,
    commitment,
    parse_atom,
)
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.action_extractor import extract_plan
from rosoclingo.runs.recorded_run import RecordedCycle, RecordedPlan, RecordedRun

Actions = FrozenSet[Symbol]

#: What the core tells of a search that was ended before it had a plan.
_ENDED = ("search was interrupted", "search was ended", "not found in time", "is dropped")


class CycleVerdict(Enum):
    """What is to be said of a cycle's decision."""

    SAME = "the same plan"
    NONE = "no plan, then as now"
    AS_SHORT = "another plan, as short"
    LONGER = "a longer plan than the one found now"
    SHORTER = "a shorter plan than the one found now"
    MISSED = "no plan, though there is one"
    WRONG = "no plan of the program"
    SENT = "other actions went out than the plan has"
    REFUSED = "an update that is refused now"


#: Those with which the decision and the one found now agree.
AGREEING = (CycleVerdict.SAME, CycleVerdict.NONE, CycleVerdict.AS_SHORT)


class Shown(NamedTuple):
    """An answer, and its horizon."""

    atoms: Answer
    horizon: int


@dataclass(frozen=True)
class CycleReport:
    """What became of a cycle.

    Attributes:
        cycle: its number.
        verdict: how what was decided compares with what is found now.
        why: in words, where they differ.
        explained: whether the difference, if there is one, is as it may be.
        published: the answer with the published plan, None where there is none.
        found: the answer that was found now, None where there is none.

    """

    cycle: int
    verdict: CycleVerdict
    why: str = ""
    explained: bool = True
    published: Optional[Shown] = None
    found: Optional[Shown] = None

    def line(self) -> str:
        """The report in one line."""
        mark = "" if self.explained else "UNEXPLAINED: "
        return f"cycle {self.cycle}: {mark}{self.verdict.value}" + (f": {self.why}" if self.why else "")


class Replay:
    """Solves the updates of a run again, cycle by cycle."""

    def __init__(
        self,
        run: RecordedRun,
        program: ReactiveProgram,
        plan_time: Optional[float] = None,
        search_time: float = 0.0,
    ) -> None:
        """Prepare to replay ``run``.

        Args:
            run: what was recorded.
            program: its program.
            plan_time: seconds of processor time for a shorter plan than the first one; None: each is the shortest.
            search_time: seconds of processor time for each search, 0 for no limit.

        """
        self._run, self._plan_time, self._search_time = run, plan_time, search_time
        self._solver = PlanSolver(program, plan_time=plan_time)
        if run.start is not None:
            self._solver.restore(run.start)

    def reports(self) -> Iterator[CycleReport]:
        """Yield what became of each cycle, in order; after an update that is refused there is no more."""
        for cycle in self._run.cycles:
            report = self._replayed(cycle)
            yield report
            if report.verdict is CycleVerdict.REFUSED:
                return

    def _replayed(self, cycle: RecordedCycle) -> CycleReport:
        plans = [_Published.of(plan) for plan in cycle.plans]
        try:
            for update in cycle.updates:
                self._begin_with(plans[-1] if plans else None, update)
                result = self._search(update)
        except SolverError as error:
            return CycleReport(cycle.cycle, CycleVerdict.REFUSED, str(error), explained=False)
        try:
            report = self._judged(cycle, plans, result)
        except SolverError as error:
            return CycleReport(cycle.cycle, CycleVerdict.WRONG, str(error), explained=False)
        return replace(report, found=_shown(result))

    def _begin_with(self, published: Optional["_Published"], update: StreamUpdate) -> None:
        """Let the search begin with the published plan, as the core's may have begun with one that it knew."""
        log = self._solver.log
        if published is not None and published.actions and log.plan is not None:
            step = update.step or 1
            if log.plan.rest(step).actions != published.actions:
                self._solver.restore(log.adopt(Plan(published.actions, published.horizon)))

    def _judged(self, cycle: RecordedCycle, plans: Sequence["_Published"], result: SolveResult) -> CycleReport:
        """Compare what was decided in a cycle with what was found now."""
        number, published = cycle.cycle, plans[-1] if plans else None
        if published is None or not published.actions:
            return self._without(cycle, published, result)
        found = _actions(result, number)
        for plan in dict.fromkeys(plans):
            if plan.actions and plan.actions != found:
                answer = self._answer_with(number, plan)
                if answer is None:
                    return CycleReport(number, CycleVerdict.WRONG, self._first_wrong(number, plan), explained=False)
                shown = answer
        if published.actions == found:
            report = CycleReport(number, CycleVerdict.SAME, published=_shown(result))
        else:
            report = replace(self._compared(number, published, result), published=shown)
        return self._sent(cycle, published, report)

    def _compared(self, number: int, published: "_Published", result: SolveResult) -> CycleReport:
        """Compare two plans that are different."""
        if result.outcome is SolveOutcome.SATISFIABLE and published.horizon == result.horizon:
            return CycleReport(number, CycleVerdict.AS_SHORT)
        then, now = published.horizon - number + 1, result.horizon - number + 1
        if result.outcome is SolveOutcome.SATISFIABLE and published.horizon > result.horizon:
            in_time = self._plan_time is not None
            why = f"the best known in time had {then} steps, now one of {now} is found"
            if not in_time:
                why = f"{then} steps, though each plan was to be shortest, and one of {now} is found"
            return CycleReport(number, CycleVerdict.LONGER, why, explained=in_time)
        limited = result.outcome is SolveOutcome.INTERRUPTED or not result.shortest
        why = f"{then} steps; now none is found in time" if not result.answers else f"{then} steps, {now} are found now"
        return CycleReport(number, CycleVerdict.SHORTER, why, explained=limited)

    def _without(self, cycle: RecordedCycle, published: Optional["_Published"], result: SolveResult) -> CycleReport:
        """Judge a cycle without a plan: nothing was to be done, there was none, or the search for it was left."""
        number, answered = cycle.cycle, result.outcome is SolveOutcome.SATISFIABLE
        if cycle.dispatched:
            why = f"{', '.join(cycle.dispatched)}, and no plan was published"
            return CycleReport(number, CycleVerdict.SENT, why, explained=False)
        if not answered or not _actions(result, number):
            verdict = CycleVerdict.SAME if answered else CycleVerdict.NONE
            return CycleReport(number, verdict, published=_shown(result))
        idle = None if published is None else self._answer_with(number, published)
        if idle is not None:
            return replace(self._compared(number, _Published(frozenset(), idle.horizon), result), published=idle)
        left = [text for text in cycle.problems if any(words in text for words in _ENDED)]
        why = left[-1] if left else "and the core reported no search that was ended"
        if published is None and not left:  # the log says the same only once a minute
            why = "the search was interrupted: it published no plan"
        return CycleReport(number, CycleVerdict.MISSED, why, explained=bool(left) or published is None)

    @staticmethod
    def _sent(cycle: RecordedCycle, published: "_Published", report: CycleReport) -> CycleReport:
        """Look whether what went out is what the plan has for the cycle."""
        planned = {str(action) for action in published.actions if cycle_of(action) == cycle.cycle}
        if cycle.dispatched is None or planned == set(cycle.dispatched):
            return report
        why = f"{', '.join(cycle.dispatched)} in place of {', '.join(sorted(planned)) or 'none'}"
        return replace(report, verdict=CycleVerdict.SENT, why=why, explained=False)

    # ---- Questions: what they state holds until the next update -----------------------------------------------------

    def _answer_with(self, number: int, published: "_Published") -> Optional[Shown]:
        """Return an answer with exactly the actions that were published from a cycle on; None where there is none."""
        others: Actions = frozenset()
        self._solver.restore(self._solver.log.adopt(Plan(published.actions, published.horizon)))
        while True:
            result = self._ask(number, published.horizon, published.actions, others)
            if result.outcome is not SolveOutcome.SATISFIABLE:
                return None
            more = _actions(result, number) - published.actions
            if not more:
                return _shown(result)
            others |= more

    def _ask(self, number: int, horizon: int, actions: Actions, others: Actions = frozenset()) -> SolveResult:
        """Search for an answer with some actions, and without ``others``."""
        wanted = [commitment(action) for action in sorted(actions)]
        unwanted = [Statement(None, (Literal(action),)) for action in sorted(others)]
        return self._search(StreamUpdate(number, max(0, horizon - number), (Volatile(), *wanted, *unwanted)))

    def _first_wrong(self, number: int, published: "_Published") -> str:
        """Say up to which action there is a plan like the published one."""
        ordered = sorted(published.actions, key=lambda action: (cycle_of(action), str(action)))
        for count in range(1, len(ordered) + 1):
            if not self._ask(number, published.horizon, frozenset(ordered[:count])).answers:
                return f"none has {ordered[count - 1]}" + (" after what comes before it" if count > 1 else "")
        return "it leaves something undone, or there is more in every plan that has its actions"

    def _search(self, update: StreamUpdate) -> SolveResult:
        return self._solver.update(update, self._limit())

    def _limit(self) -> Optional[Callable[[], bool]]:
        """Return what ends a search that takes too long."""
        if not self._search_time:
            return None
        end = time.process_time() + self._search_time
        return lambda: time.process_time() >= end


class _Published(NamedTuple):
    """A published plan: what was still to be done, and its horizon."""

    actions: Actions
    horizon: int

    @classmethod
    def of(cls, plan: RecordedPlan) -> "_Published":
        return cls(frozenset(_atoms(plan.actions)), plan.horizon)


def _atoms(texts: Sequence[str]) -> Iterator[Symbol]:
    for text in texts:
        try:
            yield parse_atom(text)
        except OclingoError:  # the collector takes actions alone
            continue


def _actions(result: SolveResult, cycle: int) -> Actions:
    """Return the actions of the answer from a cycle on, none where there is no answer."""
    if not result.answers:
        return frozenset()
    return frozenset(action.atom for action in extract_plan(result.answers[0]).remaining(cycle))


def _shown(result: SolveResult) -> Optional[Shown]:
    return Shown(result.answers[0], result.horizon) if result.answers else None


def count(reports: Sequence[CycleReport]) -> Dict[CycleVerdict, int]:
    """Return how often each verdict was given, the frequent ones that agree first."""
    found = [report.verdict for report in reports]
    return {verdict: found.count(verdict) for verdict in CycleVerdict if verdict in found}


def summary(reports: Sequence[CycleReport]) -> List[str]:
    """Return the totals of a run in lines."""
    odd: List[CycleReport] = [report for report in reports if not report.explained]
    lines = [f"{number:6d}  {verdict.value}" for verdict, number in count(reports).items()]
    end = f"{len(odd)} unexplained: cycles {_listed(odd)}" if odd else "no unexplained difference"
    return [f"{len(reports)} cycles:", *lines, end]


def _listed(reports: Sequence[CycleReport], most: int = 10) -> str:
    numbers: Tuple[str, ...] = tuple(str(report.cycle) for report in reports[:most])
    return ", ".join(numbers) + (", ..." if len(reports) > most else "")
