"""Large neighbourhood search for better plans (Shaw 1998): most of a plan is fixed, and a part of it is free.

Each round asks for plans of several kinds:

* Any shorter plan; of half the length if the plan is long, because the first plan can be many times too long.
* The tasks of the plan in another *order*, see reorder.py. The solver checks the candidate, and whether robots wait.
* A plan with a free *window* of steps: actions before it stay, actions after it move one step earlier. Windows overlap
  by half.
* If the program optimizes, a cheaper plan of the same length, with a free window of steps.

A plan is better if it has fewer steps. If several robots have actions that go on while others end, it is better if they
take less time, see reorder.py, unless the program optimizes.

If a round finds nothing, the next round has larger windows and a higher limit of conflicts. Each plan is trimmed before
the next round of questions, see trim.py.
"""

from contextlib import suppress
from random import Random
from typing import Callable, FrozenSet, Iterable, Iterator, Optional, Set, Tuple

import clingo

from rosoclingo.oclingo.errors import StoppedError
from rosoclingo.planning.history import Plan, cycle_of, delay
from rosoclingo.planning.question import Assumptions, Question, Reply, Strategy
from rosoclingo.planning.strategies.reorder import reordered, time_cost
from rosoclingo.planning.strategies.trim import trim
from rosoclingo.planning.strategy_runner import StrategyRunner

SIZE = 16
"""Number of steps in a window of the first round; each further round enlarges it by half, up to the whole plan."""

CONFLICTS = 100
"""Limit of conflicts for a question in the first round; it doubles in each further round."""

MOST_CONFLICTS = 20_000
"""Limit of conflicts for a question in the last round; if this round finds nothing, the search is exhausted."""

COST_CONFLICTS = 1000
"""Limit of conflicts for computing the cost of a plan; most plans need few."""

WAITS = 4
"""Number of steps by which actions of a candidate can be late, because robots wait for each other."""

FEW_STEPS = 100
"""Greatest number of steps for which questions without ``#heuristic`` are worthwhile."""


class Improvement:
    """A search that improves one plan; each call of :meth:`run` resumes it."""

    def __init__(self, plan: Plan, step: int, first: int) -> None:
        """Improve ``plan`` after the present ``step``; ``first`` is the least possible horizon."""
        self._plan, self._step, self._first = plan, step, first
        self._random = Random(0)
        self._runner: StrategyRunner  # the runner of the last call
        self._present: Assumptions  # fix the actions up to the present step as executed
        self._costed: Optional[Tuple[StrategyRunner, Reply]] = None  # an answer with the plan's cost, and its grounding
        self._exhausted = self._trimmed = False
        self._ordered: FrozenSet[clingo.Symbol] = frozenset()  # the actions that were reordered first
        self._questions = self._rounds()

    def moves_to(self, plan: Plan, step: int, first: int) -> bool:
        """Continue at a later ``step`` if ``plan`` has no other tasks from there on; return whether this is so.

        Its actions can be later than in the last plan, and some can be missing.
        """
        rest = plan.rest(step).actions
        if not _tasks(rest) <= _tasks(self._plan.rest(self._step).actions):
            return False
        same = rest == self._plan.rest(step).actions
        self._trimmed = self._trimmed and same
        self._costed = self._costed if same else None
        if self._exhausted and (step > self._step or not same):  # less of the plan remains, so questions are easier
            self._exhausted, self._questions = False, self._rounds()
        self._plan, self._step, self._first = plan, step, first
        return True

    def run(self, runner: StrategyRunner) -> Strategy[Optional[Reply]]:
        """Return the first better plan, or the same plan with its cost; None after a stop, or if all is tried.

        The plan is trimmed unless a stop ends that. If actions can go on while others end, the next calls trim it.
        """
        self._runner, self._durations = runner, runner.durations
        # the first cycle that is not closed in the grounding can precede the present step
        cycles = [runner.step, self._step, *map(cycle_of, self._plan.actions)]
        self._present = self._plan.fixing(runner.actions(min(cycles), self._step))
        best: Optional[Reply] = None
        with suppress(StoppedError):
            orders: Iterator[Question] = iter(())
            rest = self._plan.rest(self._step + 1).actions
            if runner.program.actions_go_on and rest != self._ordered:
                self._ordered, orders = rest, self._reordered(CONFLICTS)
            while not runner.is_stopped():
                order = next(orders, None)
                if order is not None:  # first, because it can save many steps before the next update
                    better = yield from self._shorter(order)
                elif not self._trimmed:
                    better = yield from trim(self._plan, runner, self._step, self._first, self._present)
                    self._trimmed = better is None
                elif best is not None:
                    break
                else:
                    better = yield from self._next()
                    if self._exhausted:
                        break
                if better is not None:
                    best = better
                    self._trimmed = self._trimmed and better.plan.actions == self._plan.actions
                    self._plan = better.plan
                    if self._runner.program.actions_go_on:
                        break  # the next update can come soon
        return best

    def _next(self) -> Strategy[Optional[Reply]]:
        """Ask the next question; return the answer if it is a better plan, or the same plan with its cost."""
        question = next(self._questions, None)
        if question is None:
            self._exhausted = True
            return None
        return (yield from (self._cheaper if question.best else self._shorter)(question))

    def _shorter(self, question: Question) -> Strategy[Optional[Reply]]:
        """Return the answer to ``question`` if its plan is better, see :meth:`_cost`."""
        last = min(question.last, self._runner.horizon)  # the grounding does not grow
        if last < self._begin:  # earlier questions of the round have excluded all shorter plans
            return None
        found = yield question._replace(last=last, given=[*self._present, *question.given])
        if found.satisfiable and self._cost(found.plan) < self._cost(self._plan):
            self._costed = None
            return found
        if found.satisfiable is False and not question.given:
            self._first = last + 1
        return None

    def _cheaper(self, question: Question) -> Strategy[Optional[Reply]]:
        """Return a cheaper plan of the same length if ``question`` has such an answer.

        The first call only computes the cost of the plan; it returns the cheapest answer with the same actions.
        """
        last = self._plan.horizon
        if self._costed is None or self._costed[0] is not self._runner:
            given = self._plan.fixing(self._runner.actions(self._step, last))
            found = yield Question(last, last, given, conflicts=COST_CONFLICTS, best=True, proven=False)
            self._costed = self._runner, found._replace(optimal=False)
            return found if found.satisfiable else None
        known, given = self._costed[1], [*self._present, *question.given]
        if not known.satisfiable:
            return None
        found = yield question._replace(first=last, given=given, proven=False)
        if not found.satisfiable or found.cost > known.cost:
            return None
        self._costed = self._runner, found._replace(optimal=found.optimal and not question.given)
        return found if found.cost < known.cost else None

    # ---- Questions ---------------------------------------------------------------------------------------------------

    def _rounds(self) -> Iterator[Question]:
        """Yield questions until a round over the whole plan with the greatest limit finds nothing."""
        size, conflicts = SIZE, CONFLICTS
        optimizes = self._runner.program.optimizes
        while not self.is_proven:
            before = self._plan
            whole = size >= (self._plan.horizon - self._step if optimizes else self._length)
            yield from self._round(size, conflicts)
            if self._plan.actions != before.actions:
                continue
            if whole and conflicts >= MOST_CONFLICTS:
                return
            size = SIZE if whole else size * 3 // 2
            conflicts = min(conflicts * 2, MOST_CONFLICTS)

    def _round(self, size: int, conflicts: int) -> Iterator[Question]:
        yield from self._while_shorter(lambda: self._shorter_plans(2 * conflicts))
        first = self._step + 1
        while first <= self._plan.horizon:
            yield from self._while_shorter(lambda: self._reordered(conflicts))
            if self._length > 0:
                yield self._window(conflicts, first, first + size)
            if self._runner.program.optimizes:
                yield self._window(conflicts, first, first + size, earlier=0)
            first = max(self._step + 1, first + size // 2)

    def _while_shorter(self, questions: Callable[[], Iterable[Question]]) -> Iterator[Question]:
        """Yield ``questions`` about the plan again and again while they shorten it."""
        shortened = True
        while shortened and self._length > 0:
            horizon = self._plan.horizon
            yield from questions()
            shortened = self._plan.horizon < horizon

    def _shorter_plans(self, conflicts: int) -> Iterator[Question]:
        """Yield questions about any plan, of half the length if the plan is long."""
        last = self._begin + self._length // 2 if self._length >= 2 * SIZE else self._plan.horizon - 1
        few = self._length <= FEW_STEPS
        for advised in (True, False) if self._runner.program.advises and few else (True,):
            yield Question(self._first, last, conflicts=conflicts, advised=advised)

    def _window(self, conflicts: int, first: int, end: int, earlier: int = 1) -> Question:
        """Return the question for a plan in which the steps from ``first`` to ``end - 1`` are free.

        The actions from ``end`` on move ``earlier`` by one step. If ``earlier`` is 0, the question asks for the
        cheapest plan instead.
        """
        actions = self._plan.rest(self._step + 1).actions
        before = [(action, True) for action in actions if cycle_of(action) < first]
        after = [(delay(action, -earlier), True) for action in actions if cycle_of(action) >= end]
        last = self._plan.horizon - earlier
        return Question(self._first, last, [*before, *after], conflicts=conflicts, best=not earlier)

    def _reordered(self, conflicts: int) -> Iterator[Question]:
        """Yield questions about another order of the tasks, in which robots can wait for each other."""
        before = self._plan
        stopped, possible = self._runner.is_stopped, self._runner.first_actions
        plan = reordered(before, self._step, self._random, stopped, possible, self._durations, self._cost)
        if plan is None:
            return
        several = len(plan.actions) > plan.horizon - self._step  # a single robot waits for nobody
        waits = WAITS if self._runner.program.actions_go_on and several else 0
        last = max(self._begin, plan.horizon, min(plan.horizon + waits, before.horizon - 1))
        given = plan.excluding_others(self._runner.actions(self._step + 1, last), waits)
        yield Question(self._first, last, given, conflicts=conflicts)

    def _cost(self, plan: Plan) -> Tuple[float, int]:
        """The horizon; if actions can go on, first the time that robots take."""
        program = self._runner.program
        if program.optimizes or not program.actions_go_on:
            return 0.0, plan.horizon
        return time_cost(plan, self._plan, self._step, self._durations)

    @property
    def is_proven(self) -> bool:
        """Whether it is proven that no plan is better."""
        return self._length <= 0 and (self._is_optimal or not self._runner.program.optimizes)

    @property
    def _is_optimal(self) -> bool:
        """Whether no plan of this length costs less."""
        return self._costed is not None and self._costed[0] is self._runner and self._costed[1].optimal

    @property
    def _length(self) -> int:
        """The greatest number of steps that a shorter plan can save."""
        return self._plan.horizon - self._begin

    @property
    def _begin(self) -> int:
        """The least horizon of a shorter plan."""
        return max(self._step, self._first)


def _tasks(actions: Iterable[clingo.Symbol]) -> Set[Tuple[clingo.Symbol, clingo.Symbol]]:
    """Return interfaces and parameters of ``actions``."""
    return {(one.arguments[0], one.arguments[1]) for one in actions}
