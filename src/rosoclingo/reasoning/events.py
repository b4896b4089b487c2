"""Events of the core, which its observers receive in order."""

from dataclasses import dataclass
from enum import Enum
from typing import Callable, Dict, FrozenSet, Iterable, Optional, Tuple

from clingo import Symbol

from rosoclingo.oclingo import SolveResult, StreamUpdate
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.reasoning.goals import Goal, GoalEvent, GoalState, Outcome
from rosoclingo.reasoning.keywords import Action
from rosoclingo.reasoning.present import Present, TimePosition
from rosoclingo.reasoning.records import PersistentPart, Record, fields, tables


@dataclass(frozen=True)
class Event:
    """The base of all events: something happened in ``cycle``."""

    cycle: int


class Mode(Enum):
    """Whether the core dispatches actions. A stopped core dispatches none until the next goal arrives."""

    RUNNING = "running"
    PAUSED = "paused"
    STOPPED = "stopped"


@dataclass(frozen=True)
class ModeChanged(Event):
    """An operator has paused, continued or stopped the core, or the first goal after a stop has arrived."""

    mode: Mode


@dataclass(frozen=True)
class UpdateSent(Event):
    """The solver has accepted a stream update, which starts ``cycle``. Each update is reported once.

    ``stream`` is the update with the bound of the search and the closed cycles. The streams of a run form an online
    progression. It reproduces the plans if these were the shortest ones.
    """

    stream: str


@dataclass(frozen=True)
class PlanMade(Event):
    """The solver has answered.

    ``actions`` are the last executed actions, followed by the plan if there is one. ``ground`` and ``solve`` are the
    times for grounding and solving, in seconds of wall time.
    """

    horizon: int
    actions: Tuple[Action, ...]
    ground: float = 0.0
    solve: float = 0.0


@dataclass(frozen=True)
class StateChanged(Event):
    """The beliefs have changed.

    ``atoms`` are the shown atoms without a time, and those of the cycle with the constant ``now`` in its place.
    """

    atoms: FrozenSet[Symbol]


@dataclass(frozen=True)
class ActionsDispatched(Event):
    """The actions that begin in the cycle, which are sent together; actions that go on are not sent again."""

    actions: Tuple[Action, ...]


@dataclass(frozen=True)
class ActionsPreempted(Event):
    """Running actions, as they were sent, that the plan no longer needs. The core still awaits their returns."""

    actions: Tuple[Action, ...]


@dataclass(frozen=True)
class ReturnAccepted(Event):
    """An interface has returned the result of an action of this cycle; the return is dated as the program gets it."""

    atom: Symbol


@dataclass(frozen=True)
class GoalChanged(Event):
    """The state of a goal has changed; ``outcome`` and ``message`` are set if the goal has ended.

    A goal that the core does not accept is rejected on arrival.
    """

    key: str
    event: GoalEvent
    state: GoalState
    outcome: Optional[Outcome] = None
    message: str = ""


@dataclass(frozen=True)
class GoalUnmet(Event):
    """A goal is aborted because there is no plan for it after ``stream``."""

    key: str
    term: Symbol
    stream: Stream


@dataclass(frozen=True)
class GoalProgress(Event):
    """The state of a live goal after an answer, with the last executed actions and the plan.

    ``waits`` is the reason why the goal is queued; it is reported once, without a plan. ``remark`` is the program's
    text about an accepted goal.
    """

    key: str
    state: GoalState
    actions: Tuple[Action, ...]
    waits: str = ""
    remark: str = ""

    @property
    def position(self) -> int:
        """The number of actions of past cycles."""
        return sum(action.cycle < self.cycle for action in self.actions)


@dataclass(frozen=True)
class Problem(Event):
    """A problem; ``message`` states its cause, its place and the reaction of the core.

    ``origin`` is the interface that caused it, empty for none.
    """

    message: str
    origin: str = ""


Observer = Callable[[Event], None]


class Announcer(PersistentPart):
    """Sends the events of a core's cycles to an ``observer``.

    ``cycle`` returns the logical time, ``position`` the position of the cycle in a predicate.

    Attributes:
        emit: the observer.
        published: the cycle of the last reported update.
        state: the reported beliefs, None before the first report.

    """

    GROUP = "announced"
    FIELDS = fields(published=int)
    TABLES = tables(_recorded=("believed", Symbol, type(None)))

    def __init__(self, observer: Observer, cycle: Callable[[], int], position: TimePosition) -> None:
        self.emit, self._cycle, self._present = observer, cycle, Present(position)
        self.state: Optional[FrozenSet[Symbol]] = None
        self._recorded: Dict[Symbol, None] = {}
        self.published = 0

    @property
    def cycle(self) -> int:
        """The logical time."""
        return self._cycle()

    def restore(self, record: Record) -> None:
        """Restore from all rows."""
        super().restore(record)
        self.state = frozenset(self._recorded) or None

    def update(self, step: int, update: StreamUpdate) -> None:
        """Report an accepted update, unless another update of this step was reported before."""
        if self.published < step:
            self.updates(step, [update])

    def updates(self, step: int, updates: Iterable[StreamUpdate]) -> None:
        """Report several updates that lead to a step."""
        self.published = step
        for update in updates:
            self.emit(UpdateSent(step, str(update)))

    def plan(self, result: SolveResult, shown: Tuple[Action, ...]) -> None:
        """Report the result of a search, and the beliefs if they have changed."""
        cycle, seconds = self.cycle, result.statistics
        self.emit(PlanMade(cycle, result.horizon, shown, seconds["ground"], seconds["solve"]))
        if not result.answers:
            return
        before, state = self.state or frozenset(), self._present.of(result.answers[0], cycle)
        gone, new = before - state, state - before
        if gone or new or self.state is None:
            self.state = state
            for atom in gone:
                del self._recorded[atom]
            self._recorded.update(dict.fromkeys(new))
            self.present()

    def present(self) -> None:
        """Report the beliefs, if they are known."""
        if self.state is not None:
            self.emit(StateChanged(self.cycle, self.state))

    def progress(self, step: int, goals: Iterable[Goal], shown: Tuple[Action, ...], paused: bool = False) -> None:
        """Report the progress of each goal."""
        for goal in goals:
            remark = goal.remark or (Mode.PAUSED.value if paused else "")
            self.emit(GoalProgress(step, goal.key, goal.state, shown, remark=remark))

    def problem(self, message: str, origin: str = "") -> None:
        """Report a problem."""
        self.emit(Problem(self.cycle, message, origin))
