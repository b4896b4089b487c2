"""The workers of one program: processes that can be killed whatever they do.

clingo can't be interrupted while it grounds, and a program can need more memory than there is. A worker that ignores a
stop, or crashes, is replaced by another one; as workers have no state but caches, that costs only time.
"""

import time
from contextlib import suppress
from typing import Any, Callable, Optional, Set, Type, TypeVar

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.history import History
from rosoclingo.planning.question import Stop
from rosoclingo.planning.text import Message
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.planning.workers.wire import program_to_message
from rosoclingo.planning.workers.worker import Search, Worker, WorkerLostError

T = TypeVar("T")

GRACE = 1.0
"""Seconds of wall time that a grounding can continue after a stop before it is dropped between two pieces."""

PATIENCE = 2.0
"""Seconds of wall time after a stop until the worker is killed."""

RETRIES = 1
"""How often a command that has crashed a worker is given to another one."""

LOAD = 20
"""Seconds of wall time that count as one second of work: the wait for a solver that does not work at all is bounded."""


class WorkerPool:
    """The active worker of one program, and a standby that prefetches and takes over.

    Not thread-safe. A worker runs from the start on; :meth:`close` or the end of this process ends it.

    A stop ends a search with outcome INTERRUPTED, the update stays in force. Only a grounding does not heed it: after
    ``grace`` seconds it is dropped between two pieces, after ``patience`` seconds the worker is killed. Then the update
    is dropped as a whole and DroppedError raised, as it is if workers crash again and again. While a worker loads the
    program a stop raises NotReadyError.

    Attributes:
        remarks: clingo's remarks on the program that were reported; each worker makes them again.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        models: int = 1,
        patience: float = PATIENCE,
        grace: float = GRACE,
        spare: bool = False,
        **options: Any,
    ) -> None:
        """Start a worker for ``program``; it is ready some tenths of a second later, :meth:`start` waits for that.

        Args:
            program: the reactive logic program.
            models: how many answers to compute for an update, 0 for all.
            patience: seconds of wall time after a stop until the worker is killed.
            grace: those of them in which a grounding can finish.
            spare: whether to keep a standby, which is started after the first answer.
            options: ``shortest`` for the solver of plans, else it is the incremental one, and the other options of that
                solver; plain values.

        """
        self._patience = grace, patience
        self._keeps_standby = spare
        self._load = {"do": "load", "program": program_to_message(program), "options": dict(options, models=models)}
        self._active: Optional[Worker] = None
        self._standby: Optional[Worker] = None
        self._closed = False
        self._worked = 0.0  # processor time of former active workers, while they were active
        self.remarks: Set[str] = set(program.warnings)
        self._replace()

    @property
    def pid(self) -> Optional[int]:
        """Process id of the active worker, None if there is none."""
        return None if self._active is None else self._active.pid

    @property
    def spare_pid(self) -> Optional[int]:
        """Process id of the standby, None if there is none."""
        return None if self._standby is None else self._standby.pid

    @property
    def prepares(self) -> bool:
        """Whether the standby is busy."""
        return self._standby is not None and self._standby.is_busy()

    @property
    def reached(self) -> int:
        """The last step that the search under way has ground, as far as the worker has reported."""
        return 0 if self._active is None else self._active.reached

    @property
    def worked(self) -> float:
        """Seconds of processor time that active workers have used up to now."""
        return self._worked + (0.0 if self._active is None else self._active.worked)

    def stopwatch(self) -> Callable[[], float]:
        """Return a function that returns the seconds of processor time that active workers have used since now.

        The load of the machine does not matter, but it is taken to be at most ``LOAD`` times slower.
        """
        worked, start = self.worked, time.monotonic()
        return lambda: max(self.worked - worked, (time.monotonic() - start) / LOAD)

    def __enter__(self) -> "WorkerPool":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], *rest: object) -> None:
        self.close()

    def start(self, stopped: Optional[Stop] = None) -> None:
        """Wait until a worker can solve; raises NotReadyError if ``stopped`` came first, else as a search does."""
        self._do(lambda worker: worker.wait_until_ready(stopped), stopped)

    def solver(self) -> ProcessSolver:
        """Return a solver with an empty history."""
        return ProcessSolver(self)

    def close(self) -> None:
        """End all workers; nothing can be asked any more."""
        self._closed = True
        self._discard()
        self._discard_standby()

    # ---- Asking ------------------------------------------------------------------------------------------------------

    def ask(self, command: Message, log: Optional[History], stopped: Optional[Stop], idly: bool = False) -> Message:
        """Return the reply to ``command`` as :meth:`Worker.ask` does; DroppedError stands for a lost worker."""
        return self._do(lambda worker: worker.ask(command, log, stopped, self._patience, idly), stopped)

    def search(self, search: Search, stopped: Optional[Stop]) -> Message:
        """Return the reply to ``search``; the standby takes over if it has begun that."""
        prefetched = self._standby is not None and self._standby.searches(search)
        if prefetched:
            self._replace()

        def do(worker: Worker) -> Message:
            """Ask a worker, which may have begun."""
            if worker.searches(search):
                return worker.finish(stopped, self._patience)
            return worker.ask(search.command, search.log, stopped, self._patience)

        reply = self._do(do, stopped)
        if self._active is not None and self._active.has_grown():
            self._replace()
        elif self._keeps_standby and not prefetched:
            with suppress(WorkerLostError):
                self._have_standby()
        return reply

    def prefetch(self, search: Search) -> bool:
        """Have the standby begin ``search``, in case it is asked for; return whether it does, or has the answer."""
        if self._closed or not self._keeps_standby:
            return False
        with suppress(WorkerLostError):
            begun = self._have_standby().search
            if begun is None or not begun.has_answer_of(search) or begun.log.plan != search.log.plan:
                if self._have_standby().has_grown():
                    self._discard_standby()
                self._have_standby().begin(search.command, search.log, search)
            return True
        return False

    def has_prefetched(self, search: Search) -> bool:
        """Return whether the standby has the answer to ``search``."""
        return self._standby is not None and self._standby.has_answer(search)

    def _do(self, action: Callable[[Worker], T], stopped: Optional[Stop], retries: int = RETRIES) -> T:
        """Do ``action`` with the active worker, and again with another one if it is lost before a stop."""
        if self._closed:
            raise SolverError("the solver process has been closed")
        try:
            return action(self._have())
        except WorkerLostError as error:
            self._replace()
            if not retries or (stopped is not None and stopped()):
                raise DroppedError(f"{error}; what it was asked for was dropped") from None
            return self._do(action, stopped, retries - 1)
        except SolverError:
            raise
        except BaseException:  # a message may have been read in part
            self._discard()
            raise

    # ---- Workers -----------------------------------------------------------------------------------------------------

    def _have(self) -> Worker:
        """Return the active worker, which was the standby if there is one; raises WorkerLostError as that does."""
        if self._active is None or not self._active.alive:
            self._discard()
            self._active, self._standby = self._have_standby(), None
            self._worked -= self._active.worked
        return self._active

    def _have_standby(self) -> Worker:
        """Return the standby, or a new one; raises WorkerLostError if none can be started."""
        if self._standby is None or not self._standby.alive:
            self._discard_standby()
            self._standby = Worker(self._load)
        return self._standby

    def _replace(self) -> None:
        """Have another active worker; if none can be started the next call tries again."""
        self._discard()
        with suppress(WorkerLostError):
            self._have()

    def _discard(self) -> None:
        worker, self._active = self._active, None
        if worker is not None:
            self._worked += worker.worked
            worker.kill()

    def _discard_standby(self) -> None:
        worker, self._standby = self._standby, None
        if worker is not None:
            worker.kill()
