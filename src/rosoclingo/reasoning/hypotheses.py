"""Hypothetical questions: would there be a plan without some goals and observations? One grounding answers all."""

from dataclasses import replace
from enum import Enum
from typing import Callable, Collection, FrozenSet, Iterable, List, NamedTuple, Optional, Tuple, TypeVar

from clingo import Symbol

from rosoclingo.oclingo import SolverError, Statement, StreamUpdate
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.question import Reply
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import Clock, requests_of
from rosoclingo.reasoning.keywords import Action, cancellation
from rosoclingo.reasoning.observations import Observation
from rosoclingo.reasoning.stream_planner import Planner, SearchWatch

T = TypeVar("T")
Found = TypeVar("Found")


class Impasse(NamedTuple):
    """An accepted update without a plan.

    Attributes:
        step: the next cycle, in which goals can be cancelled.
        goals: the live goals that the program has, newest first.
        observations: the observations of this update and earlier ones, newest first.
        watch: limits the time of the diagnosis, and separately the time for the reasons.
        alone: the maximum number of steps of a plan for one goal.
        facts: the facts of the update, oldest first.
        executed: the latest executed actions, oldest first.
        clock: dates facts.

    """

    step: int
    goals: Tuple[Goal, ...]
    observations: Tuple[Observation, ...]
    watch: SearchWatch
    alone: int
    facts: Tuple[Observation, ...] = ()
    executed: Tuple[Action, ...] = ()
    clock: Clock = Clock()

    def cancels(self, goals: Collection[Goal]) -> List[Symbol]:
        """Return the cancellations of some of the goals, oldest first."""
        return [cancellation(one.identifier, self.step) for one in reversed(self.goals) if one in goals]


class Way(Enum):
    """The way to drop goals: cancel them in the next update, withhold their requests, or keep all goals."""

    CANCELLED = 0
    WITHHELD = 1
    KEPT = 2


class Hypotheses:
    """Hypothetical questions about an impasse, for one way to drop goals.

    If all goals are kept, the questions concern the cycle of the impasse, otherwise the next one.
    """

    def __init__(
        self,
        planner: Planner,
        impasse: Impasse,
        way: Way,
        facts: FrozenSet[Symbol] = frozenset(),
        further: Iterable[Symbol] = (),
    ) -> None:
        """Make the ``facts`` of the stream, executed actions, and ``further`` unstated facts assumable."""
        self._planner, self._impasse, self._way = planner, impasse, way
        self._trial_planner: Optional[Planner] = None
        cancels = self._cancels(impasse.goals)
        self._assumable = frozenset([*facts, *further, *cancels, *self._requests(impasse.goals)])
        items = tuple(map(Statement, [*cancels, *further]))
        update = planner.last_update if way is Way.KEPT else StreamUpdate(impasse.step)
        self._update = replace(update, items=(*update.items, *items))

    def ask(self, kept: Collection[Goal], facts: FrozenSet[Symbol], steps: int = 0) -> Reply:
        """Return whether there is a plan for the goals ``kept`` if only ``facts`` of the assumable facts hold.

        The maximum number of steps is the lookahead of the planner, or ``steps`` if that is larger. Raises
        UndecidedError if this was not decided in time.
        """
        dropped = [goal for goal in self._impasse.goals if goal not in kept]
        disabled = self._assumable - facts - frozenset(self._cancels(dropped)) - self._requests(kept)
        steps = max(steps, self._planner.lookahead)
        try:
            if self._trial_planner is None:
                self._trial_planner = (
                    self._planner.before_update() if self._way is Way.KEPT else self._planner.restarted()
                )
            reply = self._trial_planner.inquire(self._update, self._assumable, disabled, steps)
        except SolverError:  # the update takes too long, or is refused
            raise UndecidedError from None
        if reply.satisfiable is None:
            raise UndecidedError
        return reply

    def _cancels(self, goals: Collection[Goal]) -> List[Symbol]:
        return self._impasse.cancels(goals) if self._way is Way.CANCELLED else []

    def _requests(self, goals: Collection[Goal]) -> FrozenSet[Symbol]:
        return requests_of(goals) if self._way is Way.WITHHELD else frozenset()


def facts_of(observations: Iterable[Observation]) -> FrozenSet[Symbol]:
    """Return all atoms that were stated because of the observations."""
    return frozenset().union(*(one.facts for one in observations))


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
