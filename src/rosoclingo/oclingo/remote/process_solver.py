"""A reactive solver that works in a :class:`~rosoclingo.oclingo.remote.solver_process.SolverProcess`."""

from dataclasses import replace
from typing import TYPE_CHECKING, Callable, Iterable, Optional

import clingo

from rosoclingo.oclingo.progression.updates import Over, StreamUpdate
from rosoclingo.oclingo.remote.wire import result_from_message
from rosoclingo.oclingo.solving.solver import SolveResult
from rosoclingo.oclingo.solving.stream_log import Checkpoint, Close, StreamLog, Taken

if TYPE_CHECKING:
    from rosoclingo.oclingo.remote.solver_process import SolverProcess

Stopped = Callable[[], bool]


class ProcessSolver:
    """Solves a reactive logic program under a stream of updates, in a child process.

    The methods are those of :class:`~rosoclingo.oclingo.solving.solver.ReactiveSolver`; not thread-safe.
    """

    def __init__(self, process: "SolverProcess") -> None:
        """Make a solver in ``process``, to which nothing has been fed; that does not wait for the process."""
        self._process = process
        self._place = process.place()
        self._log = StreamLog()

    @property
    def log(self) -> StreamLog:
        """All that was taken: the child's solver reads it, and so may any other."""
        return self._log

    @property
    def horizon(self) -> int:
        """N, the last grounded step."""
        return self._log.horizon

    @property
    def step(self) -> int:
        """k, the step of the last update."""
        return self._log.step

    def restore(self, log: StreamLog) -> None:
        """Go on from ``log``; the child reads it when there is need."""
        self._log = log

    def solve(self, stopped: Optional[Stopped] = None) -> SolveResult:
        """Search without an update."""
        return self._search(None, stopped)

    def update(self, update: StreamUpdate, stopped: Optional[Stopped] = None) -> SolveResult:
        """Take ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError where the update as a whole can't be taken, DroppedError where the child had to be ended;
        the log is then as it was before. An interrupted search leaves the update in force.
        """
        result = self._search(update, stopped)
        return replace(result, warnings=update.warnings + result.warnings)

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Fix the actions of ``cycle`` to those in ``executed``; the child hears of it with the next search."""
        self._log = self._log.then(Close(cycle, frozenset(executed)))

    def forget_before(self, step: int) -> None:
        """Let the steps before ``step`` be over; the child hears of it with the next search."""
        self._log = self._log.then(Over(step))

    def _search(self, update: Optional[StreamUpdate], stopped: Optional[Stopped]) -> SolveResult:
        reply = self._process.ask(self._place, self._log, update, stopped)
        self._log = self._log.then(Taken(update, reply["grounded"]))
        if reply["checkpoint"] is not None:
            self._log = self._log.then(Checkpoint(message=reply["checkpoint"])).cut()
        self._process.has_read(self._place, self._log)
        return result_from_message(reply)
