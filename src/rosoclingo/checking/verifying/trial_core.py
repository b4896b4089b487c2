"""A core for the verification: it continues from snapshots, and reports programs that leave it without a plan."""

from typing import Any, Callable, List, NamedTuple, Optional, Tuple

from rosoclingo.checking.verifying.moves import CANCEL, GOAL, Move
from rosoclingo.checking.verifying.scope import DefectKind
from rosoclingo.checking.verifying.shared_solver import SharedSolver
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.history import History
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import Event, UpdateSent
from rosoclingo.reasoning.hypotheses import Way
from rosoclingo.reasoning.records import PersistentPart, Record
from rosoclingo.reasoning.recovery import Recovery
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.situations import Response, State


class BrokenError(Exception):
    """The program leaves the core without a plan.

    Attributes:
        kind: NO_ANSWER or PUT_OFF.
        stream: the update without an answer, and its history.
        withheld: whether there would be an answer without the goals.

    """

    def __init__(self, kind: DefectKind, stream: Stream, withheld: bool = False) -> None:
        super().__init__(kind)
        self.kind, self.stream, self.withheld = kind, stream, withheld


class CoreSnapshot(NamedTuple):
    """The state of a core: the record of its parts, and the history."""

    record: Record
    log: History


_STOPS = {
    Core._lose_patience: DefectKind.PUT_OFF,
    Core._repair: DefectKind.NO_ANSWER,
    Core._forget_history: DefectKind.NO_ANSWER,
    Core._cancel_all: DefectKind.NO_ANSWER,
}
"""The responses that withhold facts or drop all goals, and the defects that they indicate."""


def _strict(row: Response) -> Response:
    """Return a row of the core's table that leaves failures to the program, and raises BrokenError for a defect."""
    if row.step is Core._settle_failures:
        return row._replace(step=lambda core, state: core.leave_failures(state))
    if row.step not in _STOPS:
        return row
    kind = _STOPS[row.step]

    def stop(core: "TrialCore", state: State) -> State:
        """Report the program as broken."""
        raise BrokenError(kind, core.stream)

    return row._replace(step=stop)


class TrialCore(Core):
    """A core that raises BrokenError where the usual one withholds facts, resets its history or loses patience.

    Attributes:
        events: the events of the last move.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        make_solver: Callable[[], SharedSolver],
        settings: CoreSettings,
        snapshot: Optional[CoreSnapshot] = None,
    ) -> None:
        """Start fresh, or continue from a ``snapshot``."""
        self.events: List[Event] = []
        record = None if snapshot is None else snapshot.record
        super().__init__(program, make_solver, self.events.append, settings, record=record)
        if snapshot is not None:
            self._planner = self._planner.with_log(snapshot.log)

    def leave_failures(self, state: State) -> State:
        """Leave failures to the program: the verification checks its reaction."""
        self._execution.unhandled.clear()
        return self._judged(state, state.result)

    def snapshot(self) -> CoreSnapshot:
        """Return the state."""
        return CoreSnapshot(self.state(), self._planner.log)

    @property
    def parts(self) -> Tuple[PersistentPart, ...]:
        """The parts with a persisted state, except for the history, as snapshots hold the history itself."""
        return super().parts[1:]

    @property
    def stream(self) -> Stream:
        """The last update and its history."""
        return self._planner.stream

    @property
    def solver(self) -> SharedSolver:
        """The solver with the last answer."""
        solver = self._planner.solver
        assert isinstance(solver, SharedSolver)
        return solver

    @property
    def due(self) -> bool:
        """Whether the core continues without an event."""
        return self._due()

    @property
    def next_step(self) -> int:
        """The step of the next update."""
        return self._announce.published + 1

    @property
    def updates(self) -> Tuple[str, ...]:
        """The updates of the last move."""
        return tuple(one.stream for one in self.events if isinstance(one, UpdateSent))

    @property
    def pending(self) -> Tuple[Any, ...]:
        """The state, apart from goals and actions, that determines the next moves."""
        feeder = self._feeder.record()
        return str(feeder["feeder:requests"]), str(feeder["feeder:rejected"]), self._plan is None

    def make(self, move: Move) -> None:
        """Apply a move, up to the next answer."""
        self.events.clear()
        for kind, term in move.arrivals:
            if kind == GOAL:
                self.add_goal(str(term), str(term))
            elif kind == CANCEL:
                self.cancel_goal(str(term))
            else:
                self.receive("sensor", [str(term)])
        for answer in move.answers:
            self.receive(answer.action.interface_name, [answer.text])
        self.advance(0.0)

    def _adopt(self, state: State, found: Recovery) -> State:
        if found.way is Way.WITHHELD:
            raise BrokenError(DefectKind.NO_ANSWER, self._planner.stream, withheld=True)
        return super()._adopt(state, found)

    #: The core's table, in which the responses that withhold facts or drop all goals raise BrokenError.
    responses = tuple(map(_strict, Core.responses))
