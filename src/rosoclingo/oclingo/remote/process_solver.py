"""A reactive solver that works in a :class:`~rosoclingo.oclingo.remote.solver_process.SolverProcess`."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Callable, FrozenSet, Iterable, List, Optional, Tuple

import clingo

from rosoclingo.oclingo.progression.updates import Over, StreamUpdate
from rosoclingo.oclingo.remote.wire import Message, result_from_message, symbols_to_text
from rosoclingo.oclingo.solving.solver import SolveResult

if TYPE_CHECKING:
    from rosoclingo.oclingo.remote.solver_process import SolverProcess

LOG_LIMIT = 10
"""Entries of a log from which on the child's state takes their place."""

Stopped = Callable[[], bool]


class Place:
    """A solver's place in the process; it lives as long as it is referred to."""

    def __init__(self, number: int) -> None:
        self.number = number


@dataclass(frozen=True)
class ProcessSnapshot:
    """State of a :class:`ProcessSolver`: all that it took, with step and horizon."""

    log: Tuple[Message, ...]
    step: int
    horizon: int

    def less(self, facts: FrozenSet[clingo.Symbol]) -> "ProcessSnapshot":
        """Return the state that would be, had none of ``facts`` been told; an action in it was not executed."""
        return (
            replace(self, log=(*self.log, {"do": "less", "facts": symbols_to_text(sorted(facts))})) if facts else self
        )


class ProcessSolver:
    """Solves a reactive logic program under a stream of updates, in a child process.

    The methods are those of :class:`~rosoclingo.oclingo.solving.solver.ReactiveSolver`; not thread-safe.
    """

    def __init__(self, process: "SolverProcess") -> None:
        """Make a solver in ``process``, to which nothing has been fed; that does not wait for the process."""
        self._process = process
        self._place = process.place()
        self._log: List[Message] = []
        self._forgets = False
        self._step, self._horizon = 1, 1

    @property
    def horizon(self) -> int:
        """N, the last grounded step."""
        return self._horizon

    @property
    def step(self) -> int:
        """k, the step of the last update."""
        return self._step

    def snapshot(self) -> ProcessSnapshot:
        """Return the present state, for :meth:`restore`."""
        return ProcessSnapshot(tuple(self._log), self._step, self._horizon)

    def restore(self, state: ProcessSnapshot) -> None:
        """Go to a state that :meth:`snapshot` gave; the child takes what led there at the next search."""
        self._log, self._step, self._horizon = list(state.log), state.step, state.horizon
        self._place = self._process.place()

    def solve(self, stopped: Optional[Stopped] = None) -> SolveResult:
        """Search without an update."""
        return self._search({"do": "solve"}, stopped)

    def update(self, update: StreamUpdate, stopped: Optional[Stopped] = None) -> SolveResult:
        """Take ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError where the update as a whole can't be taken, DroppedError where the child had to be ended;
        the state is then as it was before. An interrupted search leaves the update in force.
        """
        self._forgets = self._forgets or any(isinstance(item, Over) for item in update.items)
        result = self._search({"do": "update", "update": str(update)}, stopped)
        return replace(result, warnings=update.warnings + result.warnings)

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Fix the actions of ``cycle`` to those in ``executed``; the child hears of it with the next search."""
        self._log.append({"do": "close", "cycle": cycle, "executed": symbols_to_text(executed)})

    def forget_before(self, step: int) -> None:
        """Let the steps before ``step`` be over; from now on a search brings a state for the log now and then."""
        self._log.append({"do": "forget", "step": step})
        self._forgets = True

    def _search(self, command: Message, stopped: Optional[Stopped]) -> SolveResult:
        checkpoint = self._forgets and len(self._log) > LOG_LIMIT
        reply = self._process.ask(self._place, self._log, dict(command, checkpoint=checkpoint), stopped)
        result = result_from_message(reply)
        if checkpoint:
            self._log = [{"do": "restore", "state": reply["state"]}]
            self._process.shorten(self._place, 1)
            self._process.renew(self._place, self._log)
        else:
            self._log.append(dict(command, horizon=result.horizon))
        self._step, self._horizon = result.step, result.horizon
        return result
