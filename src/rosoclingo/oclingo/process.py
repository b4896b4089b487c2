"""A reactive solver in a process of its own, so that it can be ended whatever it does.

clingo can't be interrupted while it grounds, and a program may need more memory than there is. A
:class:`SolverProcess` answers as a :class:`~rosoclingo.oclingo.solver.ReactiveSolver` does; where its process does
not heed a stop, or crashes, the process is replaced by one that takes all accepted updates again, without searching.
"""

import time
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Callable, Iterable, List, Optional, Tuple, Type

import clingo

from rosoclingo.oclingo.errors import ProgramError, SolverError
from rosoclingo.oclingo.process_child import WorkerLostError, WorkerProcess
from rosoclingo.oclingo.process_wire import (
    Message,
    faults_from_message,
    program_to_message,
    result_from_message,
    symbols_to_text,
)
from rosoclingo.oclingo.program import ReactiveProgram
from rosoclingo.oclingo.progression import StreamUpdate
from rosoclingo.oclingo.solver import SolveResult

POLL = 0.02
"""Seconds of wall time between two looks at the stop request."""

PATIENCE = 0.5
"""Seconds of wall time that the process is given to heed a stop request before it is killed."""

Stopped = Callable[[], bool]


class DroppedError(SolverError):
    """What was asked for was dropped, since the process had to be ended or ended by itself; the state is kept."""


@dataclass(frozen=True)
class ProcessSnapshot:
    """State of a :class:`SolverProcess`: all that it took, with step and horizon."""

    log: Tuple[Message, ...]
    step: int
    horizon: int


class SolverProcess:
    """Solves a reactive logic program under a stream of updates, in a child process.

    The methods are those of :class:`~rosoclingo.oclingo.solver.ReactiveSolver`. Not thread-safe, but for
    :meth:`interrupt`. A child is running from the start on; :meth:`close` or the end of this process ends it.

    A stop request ends a search with outcome INTERRUPTED, the update stays in force. Where the child does not heed it
    (it grounds), it is killed after ``patience`` seconds, the update is dropped as a whole and DroppedError raised.
    The same holds where the child crashes.
    """

    def __init__(self, program: ReactiveProgram, models: int = 1, patience: float = PATIENCE, **options: Any) -> None:
        """Start a child for ``program``; it is ready some tenths of a second later, :meth:`start` waits for that.

        Args:
            program: the reactive logic program.
            models: how many answers to compute for an update, 0 for all.
            patience: seconds of wall time that the child has to heed a stop request.
            options: what else :class:`~rosoclingo.oclingo.solver.ReactiveSolver` takes; plain values.

        """
        self.program = program
        self.models = models
        self._patience = patience
        self._load: Message = {
            "do": "load",
            "program": program_to_message(program),
            "options": dict(options, models=models),
        }
        self._log: List[Message] = []
        self._step, self._horizon = 1, 1
        self._stop = False
        self._loaded = self._current = False
        self._child: Optional[WorkerProcess] = None
        self._closed = False
        self._respawn()

    @property
    def horizon(self) -> int:
        """N, the last grounded step."""
        return self._horizon

    @property
    def step(self) -> int:
        """k, the step of the last update."""
        return self._step

    @property
    def pid(self) -> Optional[int]:
        """Process id of the child, None where there is none."""
        return None if self._child is None else self._child.pid

    def __enter__(self) -> "SolverProcess":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], *rest: object) -> None:
        self.close()

    def start(self, stopped: Optional[Stopped] = None) -> None:
        """Wait until the child can solve; raises DroppedError where ``stopped`` or a crash came first."""
        self._call(None, stopped)

    def close(self) -> None:
        """End the child; nothing can be asked any more."""
        self._closed = True
        self._discard()

    def interrupt(self) -> None:
        """End the running search, if there is one; may be called from any thread."""
        self._stop = True

    def snapshot(self) -> ProcessSnapshot:
        """Return the present state, for :meth:`restore`."""
        return ProcessSnapshot(tuple(self._log), self._step, self._horizon)

    def restore(self, state: ProcessSnapshot) -> None:
        """Go back to a state that :meth:`snapshot` gave; the child takes what led there at the next call."""
        self._log, self._step, self._horizon = list(state.log), state.step, state.horizon
        self._current = False

    def solve(self, stopped: Optional[Stopped] = None) -> SolveResult:
        """Search without an update."""
        return self._search({"do": "solve"}, stopped)

    def update(self, update: StreamUpdate, stopped: Optional[Stopped] = None) -> SolveResult:
        """Take ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError where the update as a whole can't be taken, DroppedError where the child had to be ended;
        the state is then as it was before. An interrupted search leaves the update in force.
        """
        result = self._search({"do": "update", "update": str(update)}, stopped)
        return replace(result, warnings=update.warnings + result.warnings)

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Fix the actions of ``cycle`` to those in ``executed``."""
        command = {"do": "close", "cycle": cycle, "executed": symbols_to_text(executed)}
        self._call(command, None)
        self._log.append(command)

    def _search(self, command: Message, stopped: Optional[Stopped]) -> SolveResult:
        result = result_from_message(self._call(command, stopped))
        self._log.append(dict(command, horizon=result.horizon))
        self._step, self._horizon = result.step, result.horizon
        return result

    def _call(self, command: Optional[Message], stopped: Optional[Stopped]) -> Message:
        """Have the child ready, send ``command`` and wait for the reply."""
        if self._closed:
            raise SolverError("the solver process has been closed")
        self._stop = False

        def halt() -> bool:
            return self._stop or (stopped is not None and stopped())

        try:
            reply: Message = self._prepare(halt)
            if command is not None:
                reply = self._ask(command, halt)
        except WorkerLostError as error:
            self._respawn()
            raise DroppedError(f"{error}; what it was asked for was dropped") from None
        except BaseException:  # a reply may still be on its way
            self._discard()
            raise
        if "refused" in reply:
            raise SolverError(reply["refused"])
        return reply

    def _prepare(self, halt: Stopped) -> Message:
        """Bring the child to the state of the log."""
        if self._child is None or not self._child.alive:
            self._discard()
            self._spawn()
        reply: Message = {}
        if not self._loaded:
            reply = self._wait(halt)
            if "faults" in reply:
                raise ProgramError(faults_from_message(reply))
            self._loaded = True
        if not self._current:
            reply = self._ask({"do": "replay", "log": self._log}, halt)
            if "refused" in reply:
                raise SolverError(f"the solver can't be rebuilt: {reply['refused']}")
            self._current = True
        return reply

    def _ask(self, command: Message, halt: Stopped) -> Message:
        assert self._child is not None
        self._child.send(command)
        return self._wait(halt)

    def _wait(self, halt: Stopped) -> Message:
        """Wait for the child's reply; on ``halt`` ask it to stop, and after some patience give it up."""
        assert self._child is not None
        deadline: Optional[float] = None
        while True:
            reply = self._child.receive(POLL)
            if reply is not None:
                return reply
            if halt() and deadline is None:
                deadline = time.monotonic() + self._patience
                self._child.send({"do": "interrupt"})
            elif deadline is not None and time.monotonic() > deadline:
                raise WorkerLostError("the solver did not heed a stop, since it was grounding, and was ended")

    def _spawn(self) -> None:
        self._loaded, self._current = False, not self._log
        try:
            self._child = WorkerProcess()
        except OSError as error:
            raise WorkerLostError(f"no solver process can be started: {error}") from None
        self._child.send(self._load)

    def _respawn(self) -> None:
        """Have another child under way for the next call; where that fails, the next call tries again."""
        self._discard()
        with suppress(WorkerLostError):
            self._spawn()

    def _discard(self) -> None:
        child, self._child = self._child, None
        if child is not None:
            child.kill()
