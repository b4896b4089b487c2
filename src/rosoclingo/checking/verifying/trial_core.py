"""The core on trial: it can go back to where it was, and tells where a program leaves it without a way on."""

from typing import Any, Callable, List, NamedTuple, Optional, Tuple

from rosoclingo.checking.verifying.moves import Move
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.history import History
from rosoclingo.planning.planning_solver import PlanningSolver
from rosoclingo.reasoning.events import Event, Problem, UpdateSent
from rosoclingo.reasoning.journal.kept_core import KeptCore
from rosoclingo.reasoning.records import Record
from rosoclingo.reasoning.recovery import Recovery
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.situations import Response, State
from rosoclingo.reasoning.trials import Way

NO_ANSWER, PUT_OFF = "no-answer", "put-off"
"""What the core itself finds wrong with a program."""


class BrokenError(Exception):
    """The program leaves the core without a way on.

    Attributes:
        kind: NO_ANSWER or PUT_OFF.
        stream: the update that has no answer, and what it followed on.
        withheld: whether there is an answer if the goals had never been asked for.

    """

    def __init__(self, kind: str, stream: Stream, withheld: bool = False) -> None:
        super().__init__(kind)
        self.kind, self.stream, self.withheld = kind, stream, withheld


class CoreSnapshot(NamedTuple):
    """The state of a core: all but the solver's log, and that."""

    record: Record
    log: History


class _NoRecorder:
    """The log is kept as it is."""

    @staticmethod
    def record(log: History) -> Record:
        """Return nothing: the snapshot holds the history itself."""
        return {}


_STOPS = {
    KeptCore._lose_patience: PUT_OFF,
    KeptCore._repair: NO_ANSWER,
    KeptCore._forget_history: NO_ANSWER,
    KeptCore._cancel_all: NO_ANSWER,
}
"""The steps that doubt the facts, or drop all goals, and what is wrong with a program that needs them."""


def _trusting(row: Response) -> Response:
    """Return a row of the core's table, which stops if the program is wrong, and leaves failures to the program."""
    if row.step is KeptCore._settle_failures:
        return row._replace(step=lambda core, state: core.leave_failures(state))
    if row.step not in _STOPS:
        return row
    kind = _STOPS[row.step]

    def stop(core: "TrialCore", state: State) -> State:
        """Report the program as broken."""
        raise BrokenError(kind, core.stream)

    return row._replace(step=stop)


class TrialCore(KeptCore):
    """A core that raises BrokenError where else it would doubt what it was told, begin anew, or lose patience.

    Attributes:
        events: what it has told.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        make_solver: Callable[[], PlanningSolver],
        settings: CoreSettings,
        snapshot: Optional[CoreSnapshot] = None,
    ) -> None:
        """Begin, or go on from a snapshot."""
        self.events: List[Event] = []
        record = None if snapshot is None else snapshot.record
        super().__init__(program, make_solver, self.events.append, settings, record=record)
        self._log = _NoRecorder()  # type: ignore[assignment]
        if snapshot is not None:
            self._planner = self._planner.at(snapshot.log)

    def leave_failures(self, state: State) -> State:
        """Leave failures to the program: its reaction to them is verified, so the core must not hide it."""
        self._execution.unhandled.clear()
        return self._judged(state, state.result)

    def snapshot(self) -> CoreSnapshot:
        """Return the state."""
        return CoreSnapshot(self.record(), self._planner.log)

    @staticmethod
    def _record_beliefs() -> Record:
        """Return nothing: nobody listens to what is believed."""
        return {}

    @property
    def stream(self) -> Stream:
        """The last update, and what it followed on."""
        return self._planner.stream

    @property
    def solver(self) -> PlanningSolver:
        """The solver with the last answer."""
        return self._planner.solver

    @property
    def due(self) -> bool:
        """Whether it goes on by itself."""
        return not self.awaited and self._due()

    @property
    def next_step(self) -> int:
        """The step of the next update."""
        return self._announce.published + 1

    @property
    def updates(self) -> List[UpdateSent]:
        """The updates that the last move led to."""
        return [one for one in self.events if isinstance(one, UpdateSent)]

    @property
    def hopeless(self) -> bool:
        """Whether there is no answer before anything has come."""
        return any(isinstance(one, Problem) and "has no answer" in one.message for one in self.events)

    @property
    def pending(self) -> Tuple[Any, ...]:
        """What else than goals and actions decides how it goes on."""
        requests, rejected, *_ = self._feeder.record()["feeder"]
        return str(requests), str(rejected), self._plan is None

    def make(self, move: Move) -> None:
        """Let a move happen, and what follows from it up to the next answer."""
        self.events.clear()
        for one in move.happenings:
            if one.kind == "ask":
                self.add_goal(one.text, one.text)
            elif one.kind == "cancel":
                self.cancel_goal(one.text)
            else:
                self.receive("sensor", [one.text])
        for answer in move.answers:
            self.receive(answer.action.interface_name, [answer.text])
        self.advance(0.0)

    def _adopt(self, state: State, found: Recovery) -> State:
        if found.way is Way.WITHHELD:
            raise BrokenError(NO_ANSWER, self._planner.stream, withheld=True)
        return super()._adopt(state, found)

    #: As the core's, but it stops at each step that doubts the facts, or drops all goals.
    responses = tuple(map(_trusting, KeptCore.responses))
