"""Recovery: if there is no plan, find the fewest goals to abort, the newest first, and the reason for each.

Goals are dropped by the request ``_request(cancel(Id),C)`` in the next update, so that the stream remains a complete
record.
"""

from itertools import combinations
from typing import Callable, Collection, Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Sequence, Tuple

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
from rosoclingo.reasoning.action_extractor import extract_plan
from rosoclingo.reasoning.explanations import UnmetGoal
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.hypotheses import Hypotheses, Impasse, Way, facts_of, first_found
from rosoclingo.reasoning.input_feeder import requests_of
from rosoclingo.reasoning.observations import Observation, UnhandledFailure
from rosoclingo.reasoning.stream_planner import RECENT, Planner

#: Maximum number of observations that are reported although not all of them may matter.
FEW = 3

#: The ways to drop goals: they are cancelled, or withheld if that does not help.
WAYS = (Way.CANCELLED, Way.WITHHELD)


class Recovery(NamedTuple):
    """A plan without some goals.

    Attributes:
        planner: the planner to continue with.
        update: the update that starts the next cycle.
        result: the result of the update.
        way: the way in which the goals were dropped.
        unmet: the dropped goals with the reasons.

    """

    planner: Planner
    update: StreamUpdate
    result: SolveResult
    way: Way
    unmet: Tuple[UnmetGoal, ...] = ()

    @property
    def met(self) -> bool:
        """Whether there is a plan for the remaining goals."""
        return self.result.outcome is SolveOutcome.SATISFIABLE


def recover(planner: Planner, impasse: Impasse) -> Optional[Recovery]:
    """Find the fewest goals to drop; None if there is no plan even without goals.

    Raises UndecidedError if this was not decided in time.
    """
    finders = (_Finder(planner, impasse, way) for way in WAYS if impasse.goals)
    found = first_found(finders, lambda one: one if one.is_possible() else None)
    return None if found is None else found.recover()


def forget_history(
    planner: Planner, step: int, why: str, problem: Callable[[str], None]
) -> Optional[Tuple[Planner, List[StreamUpdate], SolveResult]]:
    """Start again at ``step`` without a history; None if there is no answer even then. Raises UndecidedError."""
    try:
        found = planner.reset(step)
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


class Settlement(NamedTuple):
    """The reaction to failures that the program cannot handle.

    Attributes:
        planner: the planner to continue with.
        result: its result.
        unmet: the goals that rest on the failed actions.
        recovery: a plan without these goals, None if there is none or the plan is complete.

    """

    planner: Planner
    result: SolveResult
    unmet: Tuple[UnmetGoal, ...] = ()
    recovery: Optional[Recovery] = None


#: Reasons why the program cannot handle a failure.
UNHEARD, CONTRADICTS = "which no rule of the program uses", "which contradicts the program"


def settle(
    planner: Planner,
    result: SolveResult,
    impasse: Impasse,
    unhandled: Sequence[UnhandledFailure],
    problem: Callable[[str], None],
) -> Settlement:
    """Find the goals that rest on actions whose failures the program cannot handle; these goals are not met.

    Failures that no rule uses are reported to ``problem``.

    The actions count as not done if this leaves an answer. A goal rests on them if the program had the goal before, and
    each plan for it tries such an action again. If the actions count as done, or the plan has no actions left, all
    goals that the program had rest on them.
    """
    failures = tuple(one.failure for one in unhandled)
    unheard = [one.failure for one in unhandled if one.undone is None]
    other = _undo(planner, unheard) if unheard else None
    planner, result = other or (planner, result)
    undone = all(other is not None if one.undone is None else one.undone for one in unhandled)
    for one in unheard:
        problem(f"{one}, {UNHEARD}: it counts as {'not done' if other is not None else 'done'}")
    failed = frozenset((one.interface, one.parameter) for each in failures for one in each.actions)
    last = max(one.cycle for one in failures) + 1
    resting = [goal for goal in impasse.goals if (goal.request_cycle or 0) <= last]
    step, answers = impasse.step - 1, result.answers
    left = not answers or bool(extract_plan(answers[0]).remaining(step))
    if not resting or (undone and left and _goes_on(result, step, failed)):
        return Settlement(planner, result)
    found = _without_failed(planner, impasse, resting, failed, keeps=undone) if left else None
    gone = found[1] if found is not None else resting
    note = UNHEARD if unhandled[0].undone is None else CONTRADICTS
    unmet = tuple(UnmetGoal(goal, observations=failures, note=note) for goal in gone)
    return Settlement(planner, result, unmet, None if found is None else found[0]._replace(unmet=unmet))


def _undo(planner: Planner, failures: Sequence[Observation]) -> Optional[Tuple[Planner, SolveResult]]:
    """Count the failed actions as not done; return None if there is no answer then."""
    try:
        found = planner.corrected(facts_of(failures))
    except SolverError:
        return None
    return found if found[1].outcome is SolveOutcome.SATISFIABLE else None


def _goes_on(result: SolveResult, cycle: int, failed: FrozenSet[Tuple[Symbol, Symbol]]) -> bool:
    """Return whether the result has a plan that does not repeat failed actions from ``cycle`` on."""
    if result.outcome is not SolveOutcome.SATISFIABLE:
        return False
    return not any((one.interface, one.parameter) in failed for one in extract_plan(result.answers[0]).remaining(cycle))


def _without_failed(
    planner: Planner, impasse: Impasse, resting: List[Goal], failed: FrozenSet[Tuple[Symbol, Symbol]], keeps: bool
) -> Optional[Tuple[Recovery, List[Goal]]]:
    """Plan without the ``resting`` goals, or only without those that repeat failed actions; None without a plan."""
    options = filter(lambda one: one.met, (_plan_without(planner, impasse, resting, way) for way in WAYS))
    found = next(options, None)
    if found is None:
        return None
    if not _goes_on(found.result, impasse.step, failed):
        found = next((one for one in options if _goes_on(one.result, impasse.step, failed)), found)
    dropped, look = resting, impasse.watch()
    for goal in reversed(resting) if keeps else ():
        others = [one for one in dropped if one is not goal]
        if look() is not None or not others:
            break
        trial = _plan_without(planner, impasse, others, found.way)
        if _goes_on(trial.result, impasse.step, failed):
            found, dropped = trial, others
    return found, dropped


def _plan_without(planner: Planner, impasse: Impasse, dropped: Collection[Goal], way: Way) -> Recovery:
    """Plan from the next cycle on without some goals."""
    gone = requests_of(dropped) if way is Way.WITHHELD else frozenset()
    cancels = impasse.cancels(dropped) if way is Way.CANCELLED else ()
    update = StreamUpdate(impasse.step, items=(*map(Withdraw, sorted(gone)), *map(Statement, cancels)))
    try:
        planner = planner.restarted(gone)
        result = planner.update(update)
    except SolverError:  # planning for the remaining goals takes too long, too, or is refused
        result = SolveResult(SolveOutcome.INTERRUPTED, (), impasse.step, impasse.step)
    return Recovery(planner, update, result, way)


class _Finder:
    """Finds the fewest goals to drop in one way, and the reasons.

    Questions about reasons need assumable observations, which leave all later steps open. If there are observations
    older than RECENT cycles, the questions about goals have a much smaller grounding of their own.
    """

    def __init__(self, planner: Planner, impasse: Impasse, way: Way) -> None:
        self._planner, self._impasse, self._way = planner, impasse, way
        self._seen = facts_of(impasse.observations)
        self._about_reasons = self._about_goals = Hypotheses(planner, impasse, way, self._seen)
        if any(one.cycle < impasse.step - RECENT for one in impasse.observations):
            self._about_goals = Hypotheses(planner, impasse, way)
        self._look = impasse.watch()

    def is_possible(self) -> bool:
        """Return whether there is a plan without goals; raises UndecidedError. This question has no time limit."""
        return bool(self._about_goals.ask((), self._seen).satisfiable)

    def recover(self) -> Recovery:
        """Drop as few goals as possible; raises UndecidedError."""
        goals = self._impasse.goals
        known: List[Witness[Goal]] = [Witness(True, frozenset()), Witness(False, frozenset(goals))]
        oracle: Oracle[Goal] = yes_or_no(self._can_have)
        diagnosis = find_diagnosis(goals, remember(oracle, known))
        if not diagnosis:
            raise UndecidedError
        for mus in diagnosis.values():
            self._confirm(mus)
        found = _plan_without(self._planner, self._impasse, diagnosis, self._way)
        if not found.met:
            raise UndecidedError
        return found._replace(unmet=self._unmet(diagnosis))

    def _can_have(self, kept: Collection[Goal], steps: int = 0) -> bool:
        """Return whether there is a plan for the goals ``kept``; raises UndecidedError.

        The plan can have ``steps`` steps, or the usual number if that is larger.
        """
        self._check_time()
        return bool(self._about_goals.ask(kept, self._seen, steps).satisfiable)

    def _met(self, kept: Collection[Goal], seen: Collection[Observation]) -> bool:
        """Return whether there is a plan for the goals ``kept`` after ``seen``; raises UndecidedError."""
        self._check_time()
        return bool(self._about_reasons.ask(kept, facts_of(seen)).satisfiable)

    def _check_time(self) -> None:
        if self._look() is not None:
            raise UndecidedError

    def _confirm(self, mus: Mus[Goal]) -> None:
        """Make sure that goals cannot be met one after the other either; raises UndecidedError if undecided."""
        steps = self._impasse.alone * len(mus.items)
        if mus.minimal and steps <= self._planner.lookahead:
            return
        if not mus.minimal or self._can_have(mus.items, steps):
            raise UndecidedError

    def _unmet(self, diagnosis: Dict[Goal, Mus[Goal]]) -> Tuple[UnmetGoal, ...]:
        self._look = self._impasse.watch()
        unmet: List[UnmetGoal] = []
        for goal, mus in reversed(list(diagnosis.items())):
            seen = self._observed(mus.items)
            others = tuple(other for other in reversed(mus.items) if other is not goal)
            unmet.append(UnmetGoal(goal, others, tuple(reversed(seen.items)), seen.minimal))
        return tuple(unmet)

    def _observed(self, goals: Tuple[Goal, ...]) -> Mus[Observation]:
        """Return the observations that prevent the goals from being met together.

        The goals can depend on other observations, which are kept.
        """
        observations = self._impasse.observations
        try:
            omissions = ((some, [one for one in observations if one not in some]) for some in _omissions(observations))
            hindering, needed = next(((some, rest) for some, rest in omissions if self._met(goals, rest)), ((), []))
        except UndecidedError:
            return Mus((), minimal=False)
        if not hindering:
            return Mus(())
        known: List[Witness[Observation]] = [Witness(True, frozenset()), Witness(False, frozenset(hindering))]
        oracle: Oracle[Observation] = yes_or_no(lambda seen: self._met(goals, [*needed, *seen]))
        found = find_mus(hindering, remember(oracle, known))
        return found if found.minimal or len(found.items) <= FEW else Mus((), minimal=False)


def _omissions(observations: Tuple[Observation, ...]) -> Iterator[Tuple[Observation, ...]]:
    """Yield observations to omit: all, each one, the newest ones, the oldest ones, then small subsets."""
    numbers = range(2, len(observations))
    if observations:
        yield observations
    yield from combinations(observations, 1)
    yield from (observations[:number] for number in numbers)
    yield from (observations[-number:] for number in numbers)
    for number in numbers[: FEW - 1]:
        yield from combinations(observations, number)
