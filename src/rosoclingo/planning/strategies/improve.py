"""Shorter plans by large neighbourhoods: most of a plan stays, a part of it is free.

Three kinds of questions take turns. Of a *window* of steps, what lies before it stays and what lies behind it is done
one step earlier (Shaw's large neighbourhood search, 1998). Where an action is *put off* the plan is left: for some
steps anything is done but this action, and all is free from there on (a wide form of Harvey and Ginsberg's limited
discrepancy search, 1995); with ``#heuristic`` the rest is then what these statements advise. Which kinds of actions are
put off is learnt from what it brings (as in Ropke and Pisinger's adaptive large neighbourhood search, 2006). And where
the same is done in another *order*, which reordered_plans.py finds, nothing is free: the solver tells whether it is a
plan. A plan may also be far too long, where it was found among many steps only: each round over a long one begins with
the question for any plan of a quarter and of half the steps, with what ``#heuristic`` advises and without. Where a
round brings nothing, the next has larger windows and more conflicts. Plans that are found are trimmed, see trim.py.

Without ``#heuristic`` it does not help to defer an action, and orders take more time than they save. Then only windows
are asked for, from small ones to the whole plan, in rounds with more and more conflicts.
"""

from itertools import product
from random import Random
from typing import Dict, Iterator, List, NamedTuple, Optional, Tuple

import clingo

from rosoclingo.planning.asking import Asking
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.question import Question, Reply, StoppedError, Strategy
from rosoclingo.planning.strategies.reordered_plans import ReorderedPlans
from rosoclingo.planning.strategies.trim import moved, trimmed

Given = List[Tuple[clingo.Symbol, bool]]

SIZE = 16
"""Steps of a window, at first; half as many more in each further round."""

CONFLICTS = 100
"""Conflicts that a question may take, at first; twice as many in each further round."""

PUT_OFFS = 4
"""So many times an action is put off after each window."""

FEWER = 4
"""So many times fewer conflicts it may take to put an action off: that leads to a plan at once or not at all."""

SHARES = (4, 2)
"""A plan of so many times fewer steps is asked for, with so many times more conflicts, which are cheaper there."""

FEW_STEPS = 100
"""Without advice no plan of more steps is asked for: that leads to one only among few steps."""

SPANS = (1, 4, 8, 16, 32, 64)
"""For so many steps an action is put off, one as likely as the other."""

TIMES_CUT = 20
"""Limit of times in a row that an interrupted question is asked again; it profits from clasp's learnt clauses."""

MOST_CONFLICTS = 20_000
"""Where so many conflicts a question bring nothing for the whole plan, nothing is left to try."""


class Part(NamedTuple):
    """The free part of a plan.

    Attributes:
        first: its first step.
        last: its last one, None where all is free to the end.
        put_off: an action at the first step, not to be done there.
        span: nor within so many steps.
        share: so many times fewer steps are left to the plan.
        advised: whether what ``#heuristic`` says counts.
        instead: a plan that is asked for, in which nothing is free; None for one of which a part is.

    """

    first: int
    last: Optional[int] = None
    put_off: Optional[clingo.Symbol] = None
    span: int = 1
    share: int = 1
    advised: bool = True
    instead: Optional[Plan] = None

    def given(self, plan: Plan) -> Given:
        """Return what is assumed of the actions of ``plan``: those behind the part are done one step earlier."""
        if self.instead is not None:
            return [(action, True) for action in self.instead.actions]
        given = [one for action in plan.actions for one in self._assumed(action)]
        if self.put_off is not None:
            given += [(moved(self.put_off, steps), False) for steps in range(self.span)]
        return given

    def last_horizon(self, begin: int, length: int) -> int:
        """Return the last horizon to look at, where the least is ``begin`` and the plan's is ``length`` steps later."""
        return begin + length // self.share if self.instead is None else max(begin, self.instead.horizon)

    def _assumed(self, action: clingo.Symbol) -> Given:
        cycle = cycle_of(action)
        if cycle < self.first:
            return [(action, True)]
        if self.last is not None and cycle > self.last:
            return [(moved(action, -1), True)]
        return []


END = Part(-1)
"""Nothing is left to try."""


class Improvement:
    """What is tried to shorten one plan; it goes on with what it comes to as long as it is of use."""

    def __init__(self, plan: Plan, step: int, first: int) -> None:
        """Shorten ``plan`` behind ``step``, the present one; no answer may have a horizon before ``first``."""
        self._plan, self._step, self._first = plan, step, first
        self._size, self._conflicts = SIZE, CONFLICTS
        self._random = Random(0)
        self._shortened = False  # in this round
        self._brought: Dict[clingo.Symbol, Tuple[int, int]] = {}  # kind of actions -> put off, how often of use
        self._orders = ReorderedPlans()
        self._advised = False  # whether the program has #heuristic statements
        self._cut_off: Optional[Part] = None  # interrupted by a stop, asked again next
        self._times_cut = 0  # in a row
        self._ended = False
        self._parts = self._rounds()

    def goes_on(self, plan: Plan, step: int, first: int) -> bool:
        """Go on at a later ``step``, if ``plan`` is the one to be shortened; tell whether it is."""
        same = plan.horizon == self._plan.horizon and plan.since(step).actions == self._plan.since(step).actions
        if same:
            if self._ended and step > self._step:  # the rest is shorter by now, and so are the questions
                self._ended, self._size, self._parts = False, SIZE, self._rounds()
            self._plan, self._step, self._first = plan, step, first
        return same

    def run(self, asking: Asking) -> Strategy[Optional[Reply]]:
        """Return a shorter plan as soon as one is found; None if a stop came first, or nothing is left to try."""
        self._advised = asking.program.advises
        present: Optional[Given] = None
        while not asking.is_stopped():
            present = self._present(asking) if present is None else present
            part = self._cut_off or next(self._parts, END)
            self._cut_off = None
            if part is END:
                self._ended = True
                break
            if part is None or not (part.advised or (self._advised and self._length // part.share <= FEW_STEPS)):
                continue
            given = [*present, *part.given(self._plan.since(self._step + 1))]
            conflicts = self._conflicts * part.share // (1 if part.put_off is None else FEWER)
            last = min(self._plan.horizon - 1, asking.horizon, part.last_horizon(self._begin, self._length))
            try:
                found = yield Question(self._first, last, given, conflicts=conflicts, advised=part.advised)
            except StoppedError:
                self._times_cut += 1
                self._cut_off = part if self._times_cut <= TIMES_CUT else None
                break
            self._times_cut = 0
            if found.satisfiable:
                return (yield from self._take(asking, present, found))
            if found.satisfiable is False and part._replace(share=1, advised=True) == Part(self._step + 1):
                self._first = last + 1  # there is none up to it
        return None

    def _present(self, asking: Asking) -> Given:
        """Return what is committed or running: nothing else, and nothing less, is done up to the present step.

        That includes the steps since the grounding was built, of which it does not know what was done.
        """
        cycles = [asking.step, self._step, *map(cycle_of, self._plan.actions)]
        open_actions = asking.actions(min(cycles), self._step)
        return [(action, action in self._plan.actions) for action in open_actions]

    def _take(self, asking: Asking, present: Given, found: Reply) -> Strategy[Reply]:
        """Adopt ``found`` as the plan, without superfluous actions and idle steps unless a stop came."""
        found = yield from trimmed(found, asking, self._step, self._first, present)
        self._plan = Plan.of(found.answers[-1], found.horizon)
        self._shortened = True
        return found

    # ---- Which parts -------------------------------------------------------------------------------------------------

    def _rounds(self) -> Iterator[Optional[Part]]:
        """Yield parts until a round over all of the plan has brought nothing, however hard it was tried."""
        while self._length > 0:
            whole = self._size >= self._length
            self._shortened = False
            yield from self._round()
            if not self._shortened:
                if whole and self._conflicts >= MOST_CONFLICTS:
                    return
                again = whole and not self._advised
                self._size = SIZE if again else self._size * 3 // 2
                self._conflicts = min(self._conflicts * 2, MOST_CONFLICTS)

    def _round(self) -> Iterator[Optional[Part]]:
        """Yield other orders, then windows to the end, which overlap by half; after each some actions are put off."""
        horizon = self._plan.horizon + 1
        while self._plan.horizon < horizon:
            horizon = self._plan.horizon
            yield from self._reordered()
        first = self._step + 1
        for share, advised in product(SHARES, (True, False)):
            if self._length >= 2 * SIZE:
                yield Part(first, share=share, advised=advised)
        while first <= self._plan.horizon and self._length > 0:
            last = first + self._size - 1
            yield Part(first, last if last < self._plan.horizon else None)
            if self._advised:
                yield from self._reordered()
            for _ in range(PUT_OFFS if self._advised else 0):
                yield from self._without_one()
                yield from self._reordered()
            first = max(self._step + 1, first + self._size // 2)

    def _without_one(self) -> Iterator[Part]:
        """Yield a part in which an action is put off, and see what it brings; none where nothing is to be done."""
        kinds: Dict[clingo.Symbol, List[clingo.Symbol]] = {}
        for action in sorted(self._plan.since(self._step + 1).actions):
            kinds.setdefault(action.arguments[0], []).append(action)
        if self._length <= 0 or not kinds:
            return
        brought = [self._brought.get(kind, (1, 1)) for kind in kinds]
        (kind,) = self._random.choices(list(kinds), [useful / tried for tried, useful in brought])
        action, horizon = self._random.choice(kinds[kind]), self._plan.horizon
        yield Part(cycle_of(action), put_off=action, span=self._random.choice(SPANS))
        tried, useful = self._brought.get(kind, (1, 1))
        self._brought[kind] = tried + 1, useful + (self._plan.horizon < horizon)

    def _reordered(self) -> Iterator[Optional[Part]]:
        """Yield the shortest of some plans that do the same in another order; half as short a one where it is none.

        Yields None between, as it takes a while to find orders.
        """
        tried = True
        while tried:  # once more where the robot has gone on meanwhile
            step, horizon = self._step, self._plan.horizon
            shorter: List[Plan] = []
            for one in self._orders.shorter(self._plan, step):
                if one is not None:
                    shorter.append(one)
                yield None
                if self._step != step:
                    break
            tried = bool(shorter)
            while shorter and self._step == step and self._plan.horizon == horizon:
                yield Part(step + 1, instead=shorter[-1])
                shorter = shorter[: len(shorter) // 2]
            if tried and self._step == step:
                self._orders.learn(useful=self._plan.horizon < horizon)
                return

    @property
    def _length(self) -> int:
        """How many steps of the plan might be left out."""
        return self._plan.horizon - self._begin

    @property
    def _begin(self) -> int:
        """The least horizon that a shorter plan might have."""
        return max(self._step, self._first)
