"""What to give up when the solver finds no plan: as few goals as possible, the newest first, and why each of them.

Goals are given up in the next update, by the program's own means, ``_request(cancel(Id),C)``; so the stream that was
sent stays a true record. What would be without a goal or an observation is found out on a solver beside it.
"""

from dataclasses import replace
from itertools import combinations
from typing import (
    Callable,
    Collection,
    Dict,
    FrozenSet,
    Iterable,
    Iterator,
    List,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
    TypeVar,
)

from clingo import Symbol

from rosoclingo.oclingo import DroppedError, SolveOutcome, SolverError, SolveResult, Statement, StreamUpdate
from rosoclingo.oclingo.progression.updates import Withdraw
from rosoclingo.planning.minimal_sets import (
    Mus,
    Oracle,
    UndecidedError,
    Witness,
    find_diagnosis,
    find_mus,
    remember,
    yes_or_no,
)
from rosoclingo.planning.question import UNKNOWN, Reply
from rosoclingo.reasoning.action_extractor import extract_plan
from rosoclingo.reasoning.explanations import UnmetGoal
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import requests_of
from rosoclingo.reasoning.keywords import cancellation
from rosoclingo.reasoning.observations import Observation, UnhandledFailure
from rosoclingo.reasoning.stream_planner import Planner, SearchWatch

#: So many observations are told though it is not sure that all of them matter.
FEW = 3

T = TypeVar("T")
Found = TypeVar("Found")


class Question(NamedTuple):
    """What is to be recovered from, at ``step``: the cycle that is to start without some of the goals.

    It is known that there is no plan for ``goals``, those that are live and were fed. They are newest first, as are the
    ``observations``. ``watch`` bounds the time to find the fewest goals to give up, and that for the reasons. ``alone``
    is the number of steps within which a goal is to be met alone.
    """

    step: int
    goals: Tuple[Goal, ...]
    observations: Tuple[Observation, ...]
    watch: SearchWatch
    alone: int


class Recovery(NamedTuple):
    """A way on: ``update`` starts the next cycle on ``planner`` with ``result``, without the goals of ``unmet``.

    ``withheld`` tells that cancelling did not help, so that the requests had to be taken out of the history.
    """

    planner: Planner
    update: StreamUpdate
    result: SolveResult
    withheld: bool
    unmet: Tuple[UnmetGoal, ...] = ()

    @property
    def met(self) -> bool:
        """Whether there is a plan for the goals that are kept."""
        return self.result.outcome is SolveOutcome.SATISFIABLE


def recover(planner: Planner, question: Question) -> Optional[Recovery]:
    """Find the goals to give up. None when there is no plan even without any goal.

    Raises UndecidedError where it is not known in time which goals cannot be met.
    """

    def helping(attempts: _Attempts) -> Optional[_Attempts]:
        """Give back what helps if all goals go."""
        return attempts if attempts.can_have((), question.observations) else None

    attempts = first_found(_both_ways(planner, question), helping)
    return None if attempts is None else _fewest(attempts, question)


def is_answerable(planner: Planner, question: Question) -> bool:
    """Whether there is an answer without the goals, be they cancelled or withheld; raises UndecidedError."""

    def answer(attempts: _Attempts) -> Optional[Recovery]:
        """Plan without any goal."""
        found = attempts.without(question.goals)
        if found.result.outcome is SolveOutcome.INTERRUPTED:
            raise UndecidedError
        return found if found.met else None

    return first_found(_both_ways(planner, question), answer) is not None


def first_found(candidates: Iterable[T], find: Callable[[T], Optional[Found]]) -> Optional[Found]:
    """Return the first result of ``find`` that is not None; None if there is none.

    Raises UndecidedError if there is none and ``find`` was undecided for a candidate.
    """
    undecided = False
    for one in candidates:
        try:
            found = find(one)
        except UndecidedError:
            undecided = True
            continue
        if found is not None:
            return found
    if undecided:
        raise UndecidedError
    return None


def forget_history(
    planner: Planner, step: int, why: str, problem: Callable[[str], None]
) -> Optional[Tuple[Planner, List[StreamUpdate], SolveResult]]:
    """Forget everything except the ``step``; None if there is no answer even then. Raises UndecidedError."""
    try:
        found = planner.anew(step)
    except DroppedError:
        raise UndecidedError from None
    except SolverError:
        return None
    if found[2].outcome is SolveOutcome.INTERRUPTED:
        raise UndecidedError
    if found[2].outcome is SolveOutcome.UNSATISFIABLE:
        problem(f"the program has no answer, even without goals and facts: {why}")
        return None
    return found


class Settled(NamedTuple):
    """The reaction to failures that the program cannot handle: go on with ``result`` on ``planner``.

    ``problems`` report the failures that no rule looks at. The ``unmet`` goals rest on the failed actions; ``recovery``
    is a plan without these goals, None if there is none or nothing is left to do.
    """

    planner: Planner
    result: SolveResult
    problems: Tuple[str, ...]
    unmet: Tuple[UnmetGoal, ...] = ()
    recovery: Optional[Recovery] = None


#: Reasons why the program cannot handle a failure.
UNHEARD, CONTRADICTS = "which no rule of the program looks at", "which contradicts the program"


def settle(planner: Planner, result: SolveResult, question: Question, unhandled: Sequence[UnhandledFailure]) -> Settled:
    """Find the goals that rest on actions whose failures the program cannot handle: they do not count as met.

    The actions count as not done if the program has an answer then. A goal rests on them if the program had it
    before, and each plan for it tries such an action again. Otherwise, and where the plan has no actions left, all
    goals that the program had rest on them.
    """
    failures = tuple(one.failure for one in unhandled)
    unheard = [one.failure for one in unhandled if one.undone is None]
    other = _undo(planner, unheard) if unheard else None
    planner, result = other or (planner, result)
    undone = all(other is not None if one.undone is None else one.undone for one in unhandled)
    counted = "not done" if other is not None else "done"
    problems = tuple(f"{one}, {UNHEARD}: it counts as {counted}" for one in unheard)
    failed = frozenset((one.interface, one.parameter) for each in failures for one in each.actions)
    last = max(one.cycle for one in failures) + 1
    resting = [goal for goal in question.goals if (goal.request_cycle or 0) <= last]
    step, answers = question.step - 1, result.answers
    left = not answers or bool(extract_plan(answers[0]).remaining(step))
    if not resting or (undone and left and _goes_on(result, step, failed)):
        return Settled(planner, result, problems)
    found = _without_failed(planner, question, resting, failed, keeps=undone) if left else None
    gone = found[1] if found is not None else resting
    note = UNHEARD if unhandled[0].undone is None else CONTRADICTS
    unmet = tuple(UnmetGoal(goal, observations=failures, note=note) for goal in gone)
    return Settled(planner, result, problems, unmet, None if found is None else found[0]._replace(unmet=unmet))


def _undo(planner: Planner, failures: Sequence[Observation]) -> Optional[Tuple[Planner, SolveResult]]:
    """Let the failed actions count as not done; None if there is no answer then."""
    gone, update = _facts_of(failures), planner.in_force
    old = sorted(gone - update.heads - update.committed)
    try:
        found = planner.instead(replace(update, items=(*map(Withdraw, old), *update.less(gone).items)))
    except SolverError:
        return None
    return found if found[1].outcome is SolveOutcome.SATISFIABLE else None


def _goes_on(result: SolveResult, cycle: int, failed: FrozenSet[Tuple[Symbol, Symbol]]) -> bool:
    """Tell whether there is a plan that from ``cycle`` on does not repeat failed actions."""
    if result.outcome is not SolveOutcome.SATISFIABLE:
        return False
    return not any((one.interface, one.parameter) in failed for one in extract_plan(result.answers[0]).remaining(cycle))


def _without_failed(
    planner: Planner, question: Question, resting: List[Goal], failed: FrozenSet[Tuple[Symbol, Symbol]], keeps: bool
) -> Optional[Tuple[Recovery, List[Goal]]]:
    """Plan without the goals, or without those that repeat failed actions; None if there is no plan."""
    found: Optional[Recovery] = None
    dropped = resting
    for attempts in _both_ways(planner, question):
        without = attempts.without(dropped)
        if without.met and (found is None or _goes_on(without.result, question.step, failed)):
            found = without
        if found is not None and _goes_on(found.result, question.step, failed):
            break
    if found is None:
        return None
    look = question.watch()
    for goal in reversed(resting) if keeps else ():
        others = [one for one in dropped if one is not goal]
        if look() is not None or not others:
            break
        trial = _Attempts(planner, question, found.withheld).without(others)
        if trial.met and _goes_on(trial.result, question.step, failed):
            found, dropped = trial, others
    return found, dropped


class _Attempts:
    """What would be without some goals, which are cancelled or withheld, and had some observations not been made.

    One grounding tells, in which the facts that make the difference are in doubt.
    """

    def __init__(self, planner: Planner, question: Question, withhold: bool) -> None:
        self._planner = planner
        self._question = question
        self._withhold = withhold
        self._beside: Optional[Planner] = None
        self._refuted: List[_Refuted] = []
        self.begin()

    def begin(self) -> None:
        """Start the time limit of the next task."""
        self._look = self._question.watch()

    @property
    def lookahead(self) -> int:
        """How many steps a plan may have."""
        return self._planner.lookahead

    def without(self, dropped: Sequence[Goal]) -> Recovery:
        """Plan without some goals."""
        step = self._question.step
        gone: FrozenSet[Symbol] = requests_of(dropped) if self._withhold else frozenset()
        update = StreamUpdate(step, items=(*map(Withdraw, sorted(gone)), *map(Statement, self._cancels(dropped))))
        try:
            fresh = self._planner.restarted(gone)
            result = fresh.update(update)
        except SolverError:  # what is left of the goals takes too long, or is refused, as well
            fresh, result = self._planner, SolveResult(SolveOutcome.INTERRUPTED, (), step, step)
        return Recovery(fresh, update, result, self._withhold)

    def met(self, kept: Collection[Goal], seen: Collection[Observation], steps: int = 0) -> bool:
        """As ``can_have``, while there is time."""
        if self._look() is not None:
            raise UndecidedError
        return self.can_have(kept, seen, steps)

    def can_have(self, kept: Collection[Goal], seen: Collection[Observation], steps: int = 0) -> bool:
        """Whether there is a plan, of so many ``steps`` at least, for the goals kept; raises UndecidedError."""
        question = self._question
        disabled = _facts_of(one for one in question.observations if one not in seen)
        dropped = [goal for goal in question.goals if goal not in kept]
        disabled |= requests_of(dropped) if self._withhold else frozenset(self._cancels(kept))
        steps = max(steps, self.lookahead)
        if any(one.tells_of(disabled, steps) for one in self._refuted):
            return False
        verdict = self._ask(disabled, steps)
        if verdict.satisfiable is None:
            raise UndecidedError
        if not verdict.satisfiable:
            self._refuted.append(_Refuted(verdict.core, verdict.core & disabled, steps))
        return verdict.satisfiable

    def _ask(self, disabled: FrozenSet[Symbol], steps: int) -> Reply:
        goals = self._question.goals
        cancels = self._cancels(goals)
        assumable = _facts_of(self._question.observations)
        assumable |= requests_of(goals) if self._withhold else frozenset(cancels)
        update = StreamUpdate(self._question.step, items=tuple(map(Statement, cancels)))
        try:
            self._beside = self._beside or self._planner.restarted()
            return self._beside.inquire(update, assumable, disabled, steps)
        except SolverError:  # takes too long, or is refused
            return UNKNOWN

    def _cancels(self, goals: Collection[Goal]) -> List[Symbol]:
        """The cancellations of the goals, of the oldest first; none where goals are withheld."""
        oldest_first = [] if self._withhold else [one for one in reversed(self._question.goals) if one in goals]
        return [cancellation(one.identifier, self._question.step) for one in oldest_first]


def _both_ways(planner: Planner, question: Question) -> Iterator[_Attempts]:
    """Yield what would be if goals were cancelled, then if they were withheld; nothing where there are none."""
    for withhold in (False, True) if question.goals else ():
        yield _Attempts(planner, question, withhold)


class _Refuted(NamedTuple):
    """There is no plan of at most so many ``steps`` where of the facts in ``core`` just these are ``disabled``."""

    core: FrozenSet[Symbol]
    disabled: FrozenSet[Symbol]
    steps: int

    def tells_of(self, disabled: FrozenSet[Symbol], steps: int) -> bool:
        """Whether there is none for this reason where these facts are disabled."""
        return steps <= self.steps and self.core & disabled == self.disabled


def _facts_of(observations: Iterable[Observation]) -> FrozenSet[Symbol]:
    return frozenset().union(*(one.facts for one in observations))


def _fewest(attempts: _Attempts, question: Question) -> Recovery:
    """Give up as few goals as possible; raises UndecidedError."""
    known: List[Witness[Goal]] = [Witness(True, frozenset()), Witness(False, frozenset(question.goals))]
    oracle: Oracle[Goal] = yes_or_no(lambda kept: attempts.met(kept, question.observations))
    diagnosis = find_diagnosis(question.goals, remember(oracle, known))
    if not diagnosis:
        raise UndecidedError
    for mus in diagnosis.values():
        _confirm(attempts, question, mus)
    unmet = _unmet(attempts, question, diagnosis)  # first, while what tells of it is still ground
    found = attempts.without(list(diagnosis))
    if not found.met:
        raise UndecidedError
    return found._replace(unmet=unmet)


def _confirm(attempts: _Attempts, question: Question, mus: Mus[Goal]) -> None:
    """Make sure that goals cannot be met one after the other either; raises UndecidedError where that is not known."""
    steps = question.alone * len(mus.items)
    if mus.minimal and steps <= attempts.lookahead:
        return
    if not mus.minimal or attempts.met(mus.items, question.observations, steps):
        raise UndecidedError


def _unmet(attempts: _Attempts, question: Question, diagnosis: Dict[Goal, Mus[Goal]]) -> Tuple[UnmetGoal, ...]:
    attempts.begin()
    unmet: List[UnmetGoal] = []
    for goal, mus in reversed(list(diagnosis.items())):
        seen = _observed(attempts, mus.items, question.observations)
        others = tuple(other for other in reversed(mus.items) if other is not goal)
        unmet.append(UnmetGoal(goal, others, tuple(reversed(seen.items)), seen.minimal))
    return tuple(unmet)


def _observed(attempts: _Attempts, goals: Tuple[Goal, ...], observations: Tuple[Observation, ...]) -> Mus[Observation]:
    """Return the observations that prevent the goals from being met together; they can need others."""
    try:
        omissions = ((some, [one for one in observations if one not in some]) for some in _omissions(observations))
        hindering, needed = next(((some, rest) for some, rest in omissions if attempts.met(goals, rest)), ((), []))
    except UndecidedError:
        return Mus((), minimal=False)
    if not hindering:
        return Mus(())
    known: List[Witness[Observation]] = [Witness(True, frozenset()), Witness(False, frozenset(hindering))]
    oracle: Oracle[Observation] = yes_or_no(lambda seen: attempts.met(goals, [*needed, *seen]))
    found = find_mus(hindering, remember(oracle, known))
    return found if found.minimal or len(found.items) <= FEW else Mus((), minimal=False)


def _omissions(observations: Tuple[Observation, ...]) -> Iterator[Tuple[Observation, ...]]:
    """Yield the observations to omit: all, each, the newest ones, the oldest ones, then a few of any age."""
    numbers = range(2, len(observations))
    if observations:
        yield observations
    yield from combinations(observations, 1)
    yield from (observations[:number] for number in numbers)
    yield from (observations[-number:] for number in numbers)
    for number in numbers[: FEW - 1]:
        yield from combinations(observations, number)
