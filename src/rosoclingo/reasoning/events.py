"""What the core tells its observers: one frozen value per thing that happened, in the order it happened."""

from dataclasses import dataclass
from typing import Callable, FrozenSet, Iterable, Optional, Tuple

from clingo import Symbol

from rosoclingo.oclingo import SolveResult, StreamUpdate
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.reasoning.goals import Goal, GoalEvent, GoalState, Outcome
from rosoclingo.reasoning.keywords import Action
from rosoclingo.reasoning.present import Present


@dataclass(frozen=True)
class Event:
    """Anything that happened, in ``cycle``."""

    cycle: int


@dataclass(frozen=True)
class UpdateSent(Event):
    """A stream update is in force and starts ``cycle``; each is told once.

    ``text`` is the update as the paper prints it: what happened. ``stream`` is all that the solver took: the bound of
    the search and what is past as well; one after the other they are an online progression, which gives the same plans
    where each was the shortest.
    """

    text: str
    stream: str


@dataclass(frozen=True)
class PlanMade(Event):
    """The solver's answer for the cycle: the plan's actions by cycle, after the last few that are done.

    Without a plan there are only these.

    ``ground`` and ``solve`` are seconds of wall time.
    """

    horizon: int
    actions: Tuple[Action, ...]
    ground: float = 0.0
    solve: float = 0.0


@dataclass(frozen=True)
class StateChanged(Event):
    """What the latest answer shows of the present is another since this cycle.

    ``atoms`` hold now: those without a time, and those of the cycle, in which the constant ``now`` stands for it.
    """

    atoms: FrozenSet[Symbol]


@dataclass(frozen=True)
class ActionsDispatched(Event):
    """The actions of the cycle, to be run together."""

    actions: Tuple[Action, ...]


@dataclass(frozen=True)
class ActionsPreempted(Event):
    """Actions under way that are no longer wanted; their returns are awaited as ever."""

    actions: Tuple[Action, ...]


@dataclass(frozen=True)
class ReturnTaken(Event):
    """The answer of an interface to an action of this cycle."""

    atom: Symbol


@dataclass(frozen=True)
class FactTaken(Event):
    """Another fact about the world."""

    atom: Symbol


@dataclass(frozen=True)
class GoalChanged(Event):
    """A goal took a transition; ``outcome`` and ``message`` are set when that ended it."""

    key: str
    term: Symbol
    event: GoalEvent
    state: GoalState
    outcome: Optional[Outcome] = None
    message: str = ""


@dataclass(frozen=True)
class GoalUnmet(Event):
    """A goal is given up, as nothing on ``stream`` is a plan for it: what there is to tell about why."""

    key: str
    term: Symbol
    stream: Stream


@dataclass(frozen=True)
class GoalRefused(Event):
    """A client's goal that was never entered, with its text and the reason."""

    key: str
    text: str
    message: str


@dataclass(frozen=True)
class GoalProgress(Event):
    """A live goal after an answer: its status, and the plan after the last few actions that are done.

    ``waits`` tells why a goal that the program has not been told of has to wait; it is told once, without a plan.
    ``remark`` is the program's text about a goal that it has accepted.
    """

    key: str
    state: GoalState
    actions: Tuple[Action, ...]
    waits: str = ""
    remark: str = ""

    @property
    def position(self) -> int:
        """How many of the actions are of past cycles."""
        return sum(action.cycle < self.cycle for action in self.actions)


@dataclass(frozen=True)
class Problem(Event):
    """Something that should not be; ``message`` says what, where and what was done about it.

    ``origin`` names its interface, empty for none.
    """

    message: str
    origin: str = ""


Observer = Callable[[Event], None]


class Announcer:
    """Makes the events of a core's cycles, for an ``observer``. ``cycle`` gives the logical time point.

    ``present`` reads what holds now out of answers.

    Attributes:
        published: the cycle of the last reported update.
        state: what holds now, None if that was never reported.

    """

    def __init__(self, observer: Observer, cycle: Callable[[], int], present: Present) -> None:
        self._tell, self._cycle, self._present = observer, cycle, present
        self.state: Optional[FrozenSet[Symbol]] = None
        self.published = 0

    def update(self, step: int, update: StreamUpdate) -> None:
        """Tell the update in force, the first of a step alone."""
        if self.published < step:
            self.updates(step, [update])

    def updates(self, step: int, updates: Iterable[StreamUpdate]) -> None:
        """Tell all that leads to a step."""
        self.published = step
        for update in updates:
            self._tell(UpdateSent(step, str(update.plain), str(update)))

    def plan(self, result: SolveResult, shown: Tuple[Action, ...]) -> None:
        """Tell what a search has given."""
        cycle, seconds = self._cycle(), result.statistics
        self._tell(PlanMade(cycle, result.horizon, shown, seconds["ground"], seconds["solve"]))
        state = self._present.of(result.answers[0], cycle) if result.answers else self.state
        if state != self.state:
            self.state = state
            self.present()

    def present(self) -> None:
        """Tell what holds now, if that is known."""
        if self.state is not None:
            self._tell(StateChanged(self._cycle(), self.state))

    def progress(self, step: int, goals: Iterable[Goal], shown: Tuple[Action, ...]) -> None:
        """Tell how each of the goals stands."""
        for goal in goals:
            self._tell(GoalProgress(step, goal.key, goal.state, shown, remark=goal.remark))

    def problem(self, message: str, origin: str = "") -> None:
        """Tell of something that should not be."""
        self._tell(Problem(self._cycle(), message, origin))
