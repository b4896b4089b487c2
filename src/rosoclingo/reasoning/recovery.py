"""What to give up when the solver finds no plan: as few goals as possible, the newest first, and why each of them.

Goals are given up in the next update, by the program's own means, ``_request(cancel(Id),C)``; so the stream that was
sent stays a true record. What would be without a goal or an observation is found out on fresh solvers beside it.
"""

from typing import Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from clingo import Symbol

from rosoclingo.oclingo import SolveOutcome, SolverError, SolveResult, Statement, StreamUpdate
from rosoclingo.oclingo.progression.updates import Withdraw
from rosoclingo.reasoning.conflicts import Choice, Conflict, UndecidedError, choose, find_conflict, remembering
from rosoclingo.reasoning.explanations import UnmetGoal
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import requests_of
from rosoclingo.reasoning.keywords import cancellation
from rosoclingo.reasoning.observations import Observation
from rosoclingo.reasoning.stream_planner import Planner, SearchWatch

#: So many observations are told though it is not sure that all of them matter.
FEW = 3


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
    undecided = False
    for withhold in (False, True) if question.goals else ():
        attempts = _Attempts(planner, question, withhold)
        everything = attempts.without(question.goals)
        if everything.met:
            return _fewest(attempts, question, everything)
        undecided = undecided or everything.result.outcome is SolveOutcome.INTERRUPTED
    if undecided:
        raise UndecidedError
    return None


def is_answerable(planner: Planner, question: Question) -> bool:
    """Whether there is an answer without the goals, be they cancelled or withheld; raises UndecidedError."""
    undecided = False
    for withhold in (False, True) if question.goals else ():
        outcome = _Attempts(planner, question, withhold).without(question.goals).result.outcome
        if outcome is SolveOutcome.SATISFIABLE:
            return True
        undecided = undecided or outcome is SolveOutcome.INTERRUPTED
    if undecided:
        raise UndecidedError
    return False


class _Attempts:
    """Plans without some goals, which are cancelled or withheld, and as if some observations had not been made."""

    def __init__(self, planner: Planner, question: Question, withhold: bool) -> None:
        self._planner = planner
        self._question = question
        self._withhold = withhold
        self.latest: Optional[Recovery] = None
        self.begin()

    def begin(self) -> None:
        """Start the time limit of the next task."""
        self._look = self._question.watch()

    @property
    def lookahead(self) -> int:
        """How many steps a plan may have."""
        return self._planner.lookahead

    @property
    def over(self) -> bool:
        """Whether the time limit is reached."""
        return self._look() is not None

    def without(self, dropped: Sequence[Goal], unseen: Sequence[Observation] = (), steps: int = 0) -> Recovery:
        """Plan without some goals and observations, at least so many ``steps`` ahead."""
        step = self._question.step
        facts: FrozenSet[Symbol] = frozenset().union(*(one.facts for one in unseen))
        gone: FrozenSet[Symbol] = requests_of(dropped) if self._withhold else frozenset()
        oldest_first: Iterable[Goal] = () if self._withhold else reversed(dropped)
        cancels = (Statement(cancellation(one.identifier, step)) for one in oldest_first)
        update = StreamUpdate(step, items=(*map(Withdraw, sorted(gone)), *cancels))
        try:
            fresh = self._planner.restarted(facts | gone)
            fresh.lookahead = max(fresh.lookahead, steps)
            result = fresh.update(update)
        except SolverError:  # what is left of the goals takes too long, or is refused, as well
            fresh, result = self._planner, SolveResult(SolveOutcome.INTERRUPTED, (), step, step)
        found = Recovery(fresh, update, result, self._withhold, tuple(map(UnmetGoal, dropped)))
        if found.met:
            self.latest = found
        return found

    def known(self, dropped: Sequence[Goal], everything: Recovery) -> Recovery:
        """As ``without``, unless that has been planned just now, or ``everything`` is dropped."""
        for found in (everything, self.latest):
            if found is not None and {one.goal for one in found.unmet} == set(dropped):
                return found
        return self.without([goal for goal in self._question.goals if goal in dropped])

    def met(self, kept: Sequence[Goal], seen: Sequence[Observation], steps: int = 0) -> bool:
        """Whether there is a plan for the goals that are kept; raises UndecidedError."""
        question = self._question
        if self.over:
            raise UndecidedError
        dropped = [goal for goal in question.goals if goal not in kept]
        found = self.without(dropped, [one for one in question.observations if one not in seen], steps)
        if found.result.outcome is SolveOutcome.INTERRUPTED:
            raise UndecidedError
        return found.met


def _fewest(attempts: _Attempts, question: Question, everything: Recovery) -> Recovery:
    """Give up as few goals as possible; raises UndecidedError."""
    known: Dict[FrozenSet[Goal], bool] = {frozenset(question.goals): False, frozenset(): True}
    choice = choose(question.goals, remembering(lambda kept: attempts.met(kept, question.observations), known))
    if not choice:
        raise UndecidedError
    for _, conflict in choice:
        _confirm(attempts, question, conflict)
    found = attempts.known([goal for goal, _ in choice], everything)
    if not found.met:
        raise UndecidedError
    return found._replace(unmet=_unmet(attempts, question, choice))


def _confirm(attempts: _Attempts, question: Question, conflict: Conflict[Goal]) -> None:
    """Make sure that goals cannot be met one after the other either; raises UndecidedError where that is not known."""
    goals = conflict.things
    steps = question.alone * len(goals)
    if len(goals) == 1 or (conflict.minimal and steps <= attempts.lookahead):
        return
    if not conflict.minimal or attempts.met(goals, question.observations, steps):
        raise UndecidedError


def _unmet(attempts: _Attempts, question: Question, choice: Choice[Goal]) -> Tuple[UnmetGoal, ...]:
    attempts.begin()
    unmet: List[UnmetGoal] = []
    for goal, conflict in reversed(choice):
        seen = _observed(attempts, conflict.things, question.observations)
        others = tuple(other for other in reversed(conflict.things) if other is not goal)
        unmet.append(UnmetGoal(goal, others, tuple(reversed(seen.things)), seen.minimal))
    return tuple(unmet)


def _observed(
    attempts: _Attempts, goals: Tuple[Goal, ...], observations: Tuple[Observation, ...]
) -> Conflict[Observation]:
    """The observations without which the goals could be met together."""
    try:
        if not observations or not attempts.met(goals, ()):
            return Conflict(())
    except UndecidedError:
        return Conflict((), minimal=False)
    found = find_conflict(observations, lambda seen: attempts.met(goals, seen))
    return found if found.minimal or len(found.things) <= FEW else Conflict((), minimal=False)
