"""An incremental solver that can continue from any history."""

from typing import Any, Optional

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.reactive_solver import ReactiveSolver
from rosoclingo.oclingo.solving.results import Answer, SolveResult
from rosoclingo.oclingo.solving.stream_state import StreamState
from rosoclingo.planning.history import AcceptedUpdate, History
from rosoclingo.planning.question import Stop


class LoggedSolver(ReactiveSolver):
    """An incremental solver with the methods that a worker needs.

    Attributes:
        log: the history.

    """

    def __init__(self, program: ReactiveProgram, **options: Any) -> None:
        """Create a solver with ``options``."""
        super().__init__(program, **options)
        self.log = History()

    def restore(self, log: History) -> None:
        """Continue from the history ``log``."""
        entries = log.entries_after(self.log)
        if entries is None:
            self.state, entries = StreamState.initial(self.program), log.entries
        for one in entries:
            if isinstance(one, AcceptedUpdate):
                self.reapply(one.update, one.horizon)
        self.log = log

    def search(self, update: Optional[StreamUpdate], stopped: Stop) -> SolveResult:
        """Accept ``update``, if there is one, and search for answers; raises like :class:`ReactiveSolver`."""
        result = self.solve(stopped) if update is None else self.update(update, stopped)
        self.log = self.log.with_entries(AcceptedUpdate(update, self.horizon))
        return result

    @staticmethod
    def recent(answer: Answer) -> Answer:
        """Return ``answer``; this solver keeps the atoms of old cycles."""
        return answer

    @staticmethod
    def improve(stopped: Stop) -> None:
        """Return None; this solver has no plans to improve."""
