"""Reactive solvers in a process of their own, so that they can be ended whatever they do.

clingo can't be interrupted while it grounds, and a program may need more memory than there is. The solvers of a
:class:`SolverProcess` answer as a :class:`~rosoclingo.oclingo.solver.ReactiveSolver` does; where their process does
not heed a stop, or crashes, it is replaced by one that takes all accepted updates again, without searching.
"""

import time
import weakref
from collections import deque
from contextlib import suppress
from typing import Any, Callable, Deque, Dict, Iterator, List, Optional, Sequence, Type

from rosoclingo.oclingo.errors import DroppedError, NotReadyError, ProgramError, SolverError
from rosoclingo.oclingo.process_child import WorkerLostError, WorkerProcess
from rosoclingo.oclingo.process_solver import Place, ProcessSolver
from rosoclingo.oclingo.process_wire import Message, faults_from_message, program_to_message
from rosoclingo.oclingo.program import ReactiveProgram

POLL = 0.02
"""Seconds of wall time between two looks at the stop request."""

PATIENCE = 0.5
"""Seconds of wall time that the process is given to heed a stop request before it is killed."""

Stopped = Callable[[], bool]


class SolverProcess:
    """A child process with solvers of one reactive logic program.

    Not thread-safe. A child is running from the start on; :meth:`close` or the end of this process ends it.

    A stop request ends a search with outcome INTERRUPTED, the update stays in force. Where the child does not heed it
    (it grounds), it is killed after ``patience`` seconds, the update is dropped as a whole and DroppedError raised.
    The same holds where the child crashes. Another child then takes the updates again; a stop meanwhile raises
    NotReadyError and lets it go on with that.
    """

    def __init__(self, program: ReactiveProgram, models: int = 1, patience: float = PATIENCE, **options: Any) -> None:
        """Start a child for ``program``; it is ready some tenths of a second later, :meth:`start` waits for that.

        Args:
            program: the reactive logic program.
            models: how many answers to compute for an update, 0 for all.
            patience: seconds of wall time that the child has to heed a stop request.
            options: what else :class:`~rosoclingo.oclingo.solver.ReactiveSolver` takes; plain values.

        """
        self._patience = patience
        self._program: Message = {
            "do": "load",
            "program": program_to_message(program),
            "options": dict(options, models=models),
        }
        self._numbers: Iterator[int] = iter(range(2**62))
        self._left: List[int] = []
        self._taken: Dict[int, int] = {}  # how much of each solver's log the child has taken, or will have
        self._owed: Deque[Optional[int]] = deque()  # what the child is preparing: the program (None) or a solver
        self._child: Optional[WorkerProcess] = None
        self._closed = False
        self._respawn()

    @property
    def pid(self) -> Optional[int]:
        """Process id of the child, None where there is none."""
        return None if self._child is None else self._child.pid

    def __enter__(self) -> "SolverProcess":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], *rest: object) -> None:
        self.close()

    def start(self, stopped: Optional[Stopped] = None) -> None:
        """Wait until the child can solve; raises NotReadyError where ``stopped`` came first, else as a search does."""
        self._guarded(lambda: self._prepare(stopped), ())

    def solver(self) -> ProcessSolver:
        """Return a solver to which nothing has been fed; the child forgets it when it is no longer referred to."""
        return ProcessSolver(self)

    def close(self) -> None:
        """End the child; nothing can be asked any more."""
        self._closed = True
        self._discard()

    def place(self) -> Place:
        """Return a place for a solver in the child, free again when it is no longer referred to."""
        place = Place(next(self._numbers))
        weakref.finalize(place, self._left.append, place.number).atexit = False
        return place

    def ask(self, place: Place, log: Sequence[Message], command: Message, stopped: Optional[Stopped]) -> Message:
        """Have the solver at ``place``, whose state is that after ``log``, do a command; return the child's reply."""

        def ask() -> Message:
            """Tell the child what it has not been told of the log yet, and the command."""
            self._prepare(stopped, place.number, log)
            assert self._child is not None
            missing = list(log[self._taken[place.number] :])
            self._child.send(dict(command, solver=place.number, log=missing, left=self._take_left()))
            return self._wait(stopped)

        reply = self._guarded(ask, (place.number, log))
        if "refused" in reply:
            self._taken[place.number] = len(log)
            raise SolverError(reply["refused"])
        self._taken[place.number] = len(log) + 1
        return reply

    def shorten(self, place: Place, length: int) -> None:
        """Note that a log of ``length`` entries now leads to the state of the solver at ``place``."""
        self._taken[place.number] = length

    def _guarded(self, action: Callable[[], Message], rebuilt: Sequence[Any]) -> Message:
        """Do ``action``; where the child is lost have another one under way, which takes what it is to know again."""
        if self._closed:
            raise SolverError("the solver process has been closed")
        try:
            return action()
        except WorkerLostError as error:
            self._respawn(*rebuilt)
            raise DroppedError(f"{error}; what it was asked for was dropped") from None
        except SolverError:
            raise
        except BaseException:  # a reply may still be on its way
            self._discard()
            raise

    def _prepare(self, stopped: Optional[Stopped], number: int = -1, log: Sequence[Message] = ()) -> Message:
        """Wait until the child has the program, and the solver ``number`` in the state after ``log``."""
        if self._child is None or not self._child.alive:
            self._discard()
            self._spawn()
        if number >= 0 and number not in self._taken:
            self._rebuild(number, log)
        reply: Message = {}
        while self._owed:
            reply = self._wait(stopped, kills=False)
            prepared = self._owed.popleft()
            if "faults" in reply:
                raise ProgramError(faults_from_message(reply))
            if "refused" in reply and prepared is not None:
                del self._taken[prepared]
                if prepared == number:
                    raise SolverError(f"the solver can't be rebuilt: {reply['refused']}")
        return reply

    def _rebuild(self, number: int, log: Sequence[Message]) -> None:
        assert self._child is not None
        self._child.send({"do": "rebuild", "solver": number, "log": list(log), "left": self._take_left()})
        self._taken[number] = len(log)
        self._owed.append(number)

    def _take_left(self) -> List[int]:
        left: List[int] = []
        while self._left:
            left.append(self._left.pop())
            self._taken.pop(left[-1], None)
        return left

    def _wait(self, stopped: Optional[Stopped], kills: bool = True) -> Message:
        """Wait for the child's reply; on a stop ask it to heed that, and after some patience give it up."""
        assert self._child is not None
        deadline: Optional[float] = None
        while True:
            reply = self._child.receive(POLL)
            if reply is not None:
                return reply
            if deadline is not None:
                if time.monotonic() > deadline:
                    raise WorkerLostError("the solver did not heed a stop, since it was grounding, and was ended")
            elif stopped is not None and stopped():
                if not kills:
                    raise NotReadyError("the solver still takes again what led here; ask again")
                deadline = time.monotonic() + self._patience
                self._child.send({"do": "interrupt"})

    def _spawn(self) -> None:
        self._taken.clear()
        self._owed.clear()
        try:
            self._child = WorkerProcess()
        except OSError as error:
            raise WorkerLostError(f"no solver process can be started: {error}") from None
        self._child.send(self._program)
        self._owed.append(None)

    def _respawn(self, number: int = -1, log: Sequence[Message] = ()) -> None:
        """Have another child under way for the next call; where that fails, the next call tries again."""
        self._discard()
        with suppress(WorkerLostError):
            self._spawn()
            if number >= 0:
                self._rebuild(number, log)

    def _discard(self) -> None:
        child, self._child = self._child, None
        if child is not None:
            child.kill()
