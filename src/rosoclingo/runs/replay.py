"""Replay of a recorded run: compares the decisions of each cycle with a new search, and explains differences.

A decision is correct if it is a plan of the program and its actions were dispatched. Another plan of equal length is no
difference; a longer plan is explained if the core executed the best plan known in time.
"""

import math
import time
from collections import Counter
from dataclasses import dataclass, replace
from enum import Enum
from typing import FrozenSet, Iterator, List, NamedTuple, Optional, Sequence

from clingo import Symbol

from rosoclingo.oclingo import (
    Answer,
    Literal,
    ReactiveProgram,
    SolveOutcome,
    SolverError,
    SolveResult,
    Statement,
    StreamUpdate,
    Volatile,
    commitment,
)
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.keywords import RUNNING, is_keyword
from rosoclingo.runs.recorded_run import RecordedCycle, RecordedRun

Actions = FrozenSet[Symbol]

#: Words in the core's messages about a search that ended before it had a plan.
_ENDED = ("search was interrupted", "search was ended", "not found in time", "is dropped")


class CycleVerdict(Enum):
    """The verdicts about a cycle's decision."""

    SAME = "the same plan"
    NONE = "no plan, then as now"
    AS_SHORT = "another plan of equal length"
    LONGER = "a longer plan than the one found now"
    SHORTER = "a shorter plan than the one found now"
    MISSED = "no plan, though there is one"
    WRONG = "no plan of the program"
    SENT = "other actions were dispatched than planned"
    REFUSED = "an update that is refused now"


#: Limit of unexplained cycles that a summary lists.
LISTED = 10

#: The verdicts for decisions that agree with the new search.
AGREEING = (CycleVerdict.SAME, CycleVerdict.NONE, CycleVerdict.AS_SHORT)


class Shown(NamedTuple):
    """An answer, and its horizon."""

    atoms: Answer
    horizon: int


@dataclass(frozen=True)
class CycleReport:
    """The result of a cycle's replay.

    Attributes:
        cycle: its number.
        verdict: the comparison of the recorded decision with the new search.
        why: the difference in words.
        explained: whether the difference, if any, is expected.
        published: the answer with the published plan, None if there is none.
        found: the answer of the new search, None if there is none.

    """

    cycle: int
    verdict: CycleVerdict
    why: str = ""
    explained: bool = True
    published: Optional[Shown] = None
    found: Optional[Shown] = None

    def line(self) -> str:
        """Return the report as one line."""
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
            run: the recorded run.
            program: its program.
            plan_time: seconds of processor time to search for a shorter plan; None: search for the shortest.
            search_time: seconds of processor time for each search, 0 for no limit.

        """
        self._run, self._plan_time, self._search_time = run, plan_time, search_time
        self._program, self._solver = program, PlanSolver(program, plan_time=plan_time)
        if run.start is not None:
            self._solver.restore(run.start)

    def reports(self) -> Iterator[CycleReport]:
        """Yield the report of each cycle, in order, up to the first refused update."""
        for cycle in self._run.cycles:
            report = self._replayed(cycle)
            yield report
            if report.verdict is CycleVerdict.REFUSED:
                return

    def _replayed(self, cycle: RecordedCycle) -> CycleReport:
        try:
            for update in cycle.updates:
                self._begin_with(cycle.plans[-1] if cycle.plans else None, update)
                result = self._search(update)
        except SolverError as error:
            return CycleReport(cycle.cycle, CycleVerdict.REFUSED, str(error), explained=False)
        try:
            report = self._judged(cycle, result)
        except SolverError as error:
            return CycleReport(cycle.cycle, CycleVerdict.WRONG, str(error), explained=False)
        return replace(report, found=self._shown(result))

    def _begin_with(self, published: Optional[Plan], update: StreamUpdate) -> None:
        """Adopt the published plan, because the core's search can have started from a known plan."""
        log = self._solver.log
        if published is not None and published.actions and log.plan is not None:
            step = update.step or 1
            if log.plan.rest(step).actions != published.actions:
                self._solver.restore(log.adopt(published))

    def _judged(self, cycle: RecordedCycle, result: SolveResult) -> CycleReport:
        """Compare the decision of a cycle with the new search."""
        number, published = cycle.cycle, cycle.plans[-1] if cycle.plans else None
        if published is None or not published.actions:
            return self._without(cycle, published, result)
        found = _actions(result, number)
        for plan in dict.fromkeys(cycle.plans):
            if plan.actions and plan.actions != found:
                answer = self._answer_with(number, plan)
                if answer is None:
                    return CycleReport(number, CycleVerdict.WRONG, self._first_wrong(number, plan), explained=False)
                shown = answer
        if published.actions == found:
            report = CycleReport(number, CycleVerdict.SAME, published=self._shown(result))
        else:
            report = replace(self._compared(number, published, result), published=shown)
        return self._sent(cycle, published, report)

    def _compared(self, number: int, published: Plan, result: SolveResult) -> CycleReport:
        """Compare two different plans."""
        if result.outcome is SolveOutcome.SATISFIABLE and published.horizon == result.horizon:
            return CycleReport(number, CycleVerdict.AS_SHORT)
        then, now = published.horizon - number + 1, result.horizon - number + 1
        if result.outcome is SolveOutcome.SATISFIABLE and published.horizon > result.horizon:
            in_time = self._plan_time is not None
            why = f"the best plan known in time had {then} steps, the replay finds {now}"
            if not in_time:
                why = f"{then} steps in a run with shortest plans, the replay finds {now}"
            return CycleReport(number, CycleVerdict.LONGER, why, explained=in_time)
        limited = result.outcome is SolveOutcome.INTERRUPTED or not result.shortest
        why = f"{then} steps, the replay finds {now if result.answers else 'no plan in time'}"
        return CycleReport(number, CycleVerdict.SHORTER, why, explained=limited)

    def _without(self, cycle: RecordedCycle, published: Optional[Plan], result: SolveResult) -> CycleReport:
        """Judge a cycle without actions: nothing had to be done, there was no plan, or the search was ended."""
        number, answered = cycle.cycle, result.outcome is SolveOutcome.SATISFIABLE
        if cycle.dispatched:
            why = f"{', '.join(cycle.dispatched)}, and no plan was published"
            return CycleReport(number, CycleVerdict.SENT, why, explained=False)
        if not answered or not _actions(result, number):
            verdict = CycleVerdict.SAME if answered else CycleVerdict.NONE
            return CycleReport(number, verdict, published=self._shown(result))
        idle = None if published is None else self._answer_with(number, published)
        if idle is not None:
            return replace(self._compared(number, Plan(frozenset(), idle.horizon), result), published=idle)
        ended = [text for text in cycle.problems if any(words in text for words in _ENDED)]
        why = ended[-1] if ended else "and the core did not report that it ended the search"
        if published is None and not ended:  # the core logs equal problems at most once a minute
            why = "the search was ended, because its plan was not published"
        return CycleReport(number, CycleVerdict.MISSED, why, explained=bool(ended) or published is None)

    @staticmethod
    def _sent(cycle: RecordedCycle, published: Plan, report: CycleReport) -> CycleReport:
        """Check that the dispatched actions are those of the plan for the cycle, except for running ones."""
        going_on = [one for one in cycle.updates[-1].heads if one is not None and is_keyword(one, RUNNING)]
        running = [one.arguments[:2] for one in going_on if one.arguments[2].number == cycle.cycle - 1]
        now = (action for action in published.actions if cycle_of(action) == cycle.cycle)
        planned = {str(action) for action in now if action.arguments[:2] not in running}
        if cycle.dispatched is None or planned == set(cycle.dispatched):
            return report
        why = f"{', '.join(cycle.dispatched)} in place of {', '.join(sorted(planned)) or 'none'}"
        return replace(report, verdict=CycleVerdict.SENT, why=why, explained=False)

    # ---- questions: their statements hold until the next update -----------------------------------------------------

    def _answer_with(self, number: int, published: Plan) -> Optional[Shown]:
        """Return an answer with exactly the published actions from a cycle on, None if there is none."""
        others: Actions = frozenset()
        self._solver.restore(self._solver.log.adopt(published))
        while True:
            result = self._ask(number, published.horizon, published.actions, others, limited=False)  # actions are fixed
            if result.outcome is not SolveOutcome.SATISFIABLE:
                return None
            more = _actions(result, number) - published.actions
            if not more:
                return self._shown(result)
            others |= more

    def _ask(
        self, number: int, horizon: int, actions: Actions, others: Actions = frozenset(), limited: bool = True
    ) -> SolveResult:
        """Search for an answer with some actions, and without ``others``."""
        required = [commitment(action) for action in sorted(actions)]
        excluded = [Statement(None, (Literal(action),)) for action in sorted(others)]
        return self._search(StreamUpdate(number, max(0, horizon - number), (Volatile(), *required, *excluded)), limited)

    def _first_wrong(self, number: int, published: Plan) -> str:
        """Return a text about the first action of the published plan that no plan can contain."""
        ordered = sorted(published.actions, key=lambda action: (cycle_of(action), str(action)))
        for count in range(1, len(ordered) + 1):
            found = self._ask(number, published.horizon, frozenset(ordered[:count]))
            if found.outcome is SolveOutcome.INTERRUPTED:
                return "which of its actions is wrong was not found in time"
            if not found.answers:
                return f"none has {ordered[count - 1]}" + (" after the actions before it" if count > 1 else "")
        return "it is incomplete: each plan with its actions has further actions"

    def _search(self, update: StreamUpdate, limited: bool = True) -> SolveResult:
        end = time.process_time() + (self._search_time if limited and self._search_time else math.inf)
        return self._solver.update(update, lambda: time.process_time() >= end)

    def _shown(self, result: SolveResult) -> Optional[Shown]:
        return Shown(result.until_horizon(self._program).answers[0], result.horizon) if result.answers else None


def _actions(result: SolveResult, cycle: int) -> Actions:
    """Return the actions of the answer from a cycle on, none without an answer."""
    if not result.answers:
        return frozenset()
    return Plan.from_atoms(result.answers[0], result.horizon).rest(cycle).actions


def summary(reports: Sequence[CycleReport]) -> List[str]:
    """Return the totals of a run in lines."""
    odd = [str(report.cycle) for report in reports if not report.explained]
    found = Counter(report.verdict for report in reports)
    lines = [f"{found[verdict]:6d}  {verdict.value}" for verdict in CycleVerdict if found[verdict]]
    listed = ", ".join([*odd[:LISTED], *(["..."] if len(odd) > LISTED else [])])
    end = f"{len(odd)} unexplained: cycles {listed}" if odd else "no unexplained difference"
    return [f"{len(reports)} cycles:", *lines, end]
