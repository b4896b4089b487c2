"""Shorter plans by large neighbourhood search (Shaw 1998): most of a plan stays, a part of it is free.

Each round asks for plans of several kinds:

* The tasks of the plan in another *order*, see reorder.py. Nothing is free: the solver decides whether it is a plan.
* Any plan of half the length, as the first plan can be many times too long.
* A free *window* of steps: actions before it stay, those after it are one step earlier. Windows overlap by half.

If a round finds nothing, the next has larger windows and allows more conflicts. Each plan is trimmed, see trim.py.
"""

from random import Random
from typing import Iterator, List, Optional, Tuple

import clingo

from rosoclingo.planning.asking import Asking
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.question import Question, Reply, Stop, StoppedError, Strategy
from rosoclingo.planning.strategies.reorder import reordered
from rosoclingo.planning.strategies.trim import moved, trimmed

Assumption = Tuple[clingo.Symbol, bool]

SIZE = 16
"""Steps of a window in the first round; half as many more in each further round, until one is the whole plan."""

CONFLICTS = 100
"""Limit of conflicts of a question in the first round; it doubles with each further round."""

MOST_CONFLICTS = 20_000
"""Limit of conflicts in the last round: nothing is left to try if it finds nothing."""

FEW_STEPS = 100
"""For more steps, a question without advice finds no plan."""


class Improvement:
    """The attempts to shorten one plan. They resume with the next call as long as the plan is the same."""

    def __init__(self, plan: Plan, step: int, first: int) -> None:
        """Shorten ``plan`` after ``step``, the present one; no answer has a horizon below ``first``."""
        self._plan, self._step, self._first = plan, step, first
        self._random = Random(0)
        self._advises = False
        self._is_stopped: Stop = lambda: False
        self._ended = False
        self._questions = self._rounds()

    def goes_on(self, plan: Plan, step: int, first: int) -> bool:
        """Resume at a later ``step`` if ``plan`` is the one to shorten; return whether it is."""
        same = plan.horizon == self._plan.horizon and plan.rest(step).actions == self._plan.rest(step).actions
        if same:
            if self._ended and step > self._step:  # questions about the shorter rest are easier
                self._ended, self._questions = False, self._rounds()
            self._plan, self._step, self._first = plan, step, first
        return same

    def run(self, asking: Asking) -> Strategy[Optional[Reply]]:
        """Return a shorter plan as soon as one is found; None after a stop, or if nothing is left to try."""
        self._advises, self._is_stopped = asking.program.advises, asking.is_stopped
        present: Optional[List[Assumption]] = None
        while not asking.is_stopped():
            present = self._present(asking) if present is None else present
            question = next(self._questions, None)
            if question is None:
                self._ended = True
                break
            last = min(question.last, self._plan.horizon - 1)
            if last < self._begin:  # a question of the same round has left nothing to save
                continue
            try:
                found = yield question._replace(last=last, given=[*present, *question.given])
            except StoppedError:
                break
            if found.satisfiable:
                found = yield from trimmed(found, asking, self._step, self._first, present)
                self._plan = Plan.from_atoms(found.answers[-1], found.horizon)
                return found
            if found.satisfiable is False and not question.given:
                self._first = last + 1
        return None

    def _present(self, asking: Asking) -> List[Assumption]:
        """Return the assumptions that fix the actions up to the present step: those committed or running, no others.

        They begin with the first step that is open in the grounding, which can be older than the present step.
        """
        cycles = [asking.step, self._step, *map(cycle_of, self._plan.actions)]
        open_actions = asking.actions(min(cycles), self._step)
        return [(action, action in self._plan.actions) for action in open_actions]

    # ---- Questions ---------------------------------------------------------------------------------------------------

    def _rounds(self) -> Iterator[Question]:
        """Yield questions until a round over the whole plan finds nothing with the most conflicts."""
        size, conflicts = SIZE, CONFLICTS
        while self._length > 0:
            horizon, whole = self._plan.horizon, size >= self._length
            yield from self._round(size, conflicts)
            if self._plan.horizon < horizon:
                continue
            if whole and conflicts >= MOST_CONFLICTS:
                return
            size = SIZE if whole else size * 3 // 2
            conflicts = min(conflicts * 2, MOST_CONFLICTS)

    def _round(self, size: int, conflicts: int) -> Iterator[Question]:
        if self._length >= 2 * SIZE:
            half = self._begin + self._length // 2
            for advised in (True, False) if self._advises and self._length <= FEW_STEPS else (True,):
                yield Question(self._first, half, conflicts=2 * conflicts, advised=advised)
        first = self._step + 1
        while first <= self._plan.horizon:
            yield from self._reordered(conflicts)
            yield self._window(conflicts, first, first + size)
            first = max(self._step + 1, first + size // 2)

    def _window(self, conflicts: int, first: int, end: int) -> Question:
        """Return the question for a plan with the steps from ``first`` to ``end`` free, the latter excluded."""
        actions = self._plan.rest(self._step + 1).actions
        before = [(action, True) for action in actions if cycle_of(action) < first]
        behind = [(moved(action, -1), True) for action in actions if cycle_of(action) >= end]
        return Question(self._first, self._plan.horizon - 1, [*before, *behind], conflicts=conflicts)

    def _reordered(self, conflicts: int) -> Iterator[Question]:
        """Yield the question whether the tasks in another order are a plan; once more if they are."""
        shortened = True
        while shortened:
            horizon = self._plan.horizon
            plan = reordered(self._plan, self._step, self._random, self._is_stopped)
            if plan is not None:
                given = [(action, True) for action in plan.actions]
                yield Question(self._first, max(self._begin, plan.horizon), given, conflicts=conflicts)
            shortened = self._plan.horizon < horizon

    @property
    def _length(self) -> int:
        """The number of steps that a shorter plan could save at most."""
        return self._plan.horizon - self._begin

    @property
    def _begin(self) -> int:
        """The least horizon that a shorter plan can have."""
        return max(self._step, self._first)
