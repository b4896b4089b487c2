"""The worker processes of one program.

clingo cannot be interrupted while it grounds, and a program can need more memory than there is. A worker that ignores a
stop, or crashes, is replaced. Workers have no state except caches, so this costs only time.
"""

import time
from contextlib import suppress
from typing import Any, Callable, Optional, Set, Type, TypeVar

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.history import History
from rosoclingo.planning.question import Stop
from rosoclingo.planning.text import Message
from rosoclingo.planning.workers.wire import program_to_message
from rosoclingo.planning.workers.worker import Search, Worker, WorkerLostError

T = TypeVar("T")

GRACE = 1.0
"""Seconds of wall time after a stop until a grounding is dropped between two pieces."""

PATIENCE = 2.0
"""Seconds of wall time after a stop until the worker is killed."""

RETRIES = 1
"""Number of times that a command which crashed a worker is repeated with another one."""

WALL_PER_CPU = 20
"""Seconds of wall time that count as one second of processor time; bounds the wait for a worker that sleeps."""


class WorkerPool:
    """The active worker of one program, and a standby worker that prefetches and takes over.

    Not thread-safe. :meth:`close` or the end of this process ends the workers.

    A stop ends a search with outcome INTERRUPTED, and the update stays accepted. A grounding does not react to a stop:
    after ``grace`` seconds it is dropped between two pieces, after ``patience`` seconds the worker is killed. In both
    cases the update is dropped and DroppedError raised, as after repeated crashes of workers. While a worker loads the
    program, a stop raises NotReadyError.

    Attributes:
        remarks: clingo's remarks on the program that were reported; each new worker repeats them.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        *,
        patience: float = PATIENCE,
        grace: float = GRACE,
        standby: bool = False,
        fork: bool = False,
        **options: Any,
    ) -> None:
        """Start a worker for ``program``; :meth:`start` waits until it has loaded the program.

        Args:
            program: the reactive logic program.
            patience: seconds of wall time after a stop until the worker is killed.
            grace: seconds of wall time after a stop until a grounding is dropped between two pieces.
            standby: whether to keep a standby worker; it is started after the first answer.
            fork: whether workers are forks of this process, which is much faster; it must have no threads then.
            options: options of the solver, plain values; ``shortest`` selects :class:`PlanSolver` rather than
                :class:`ReactiveSolver`.

        """
        self._patience = grace, patience
        self._keeps_standby = standby
        self._forked = program if fork else None
        self._load = {"do": "load", "program": program_to_message(program), "options": options}
        self._active: Optional[Worker] = None
        self._standby: Optional[Worker] = None
        self._closed = False
        self._cpu_time = 0.0  # of former active workers, while they were active
        self.remarks: Set[str] = set(program.warnings)
        self._replace()

    @property
    def pid(self) -> Optional[int]:
        """Process id of the active worker, None if there is none."""
        return None if self._active is None else self._active.pid

    @property
    def standby_pid(self) -> Optional[int]:
        """Process id of the standby worker, None if there is none."""
        return None if self._standby is None else self._standby.pid

    @property
    def is_prefetching(self) -> bool:
        """Whether the standby worker is busy."""
        return self._standby is not None and self._standby.is_busy()

    @property
    def reached(self) -> int:
        """The last grounded step of the running search, as last reported."""
        return 0 if self._active is None else self._active.reached

    @property
    def cpu_time(self) -> float:
        """Seconds of processor time that active workers have used."""
        return self._cpu_time + (0.0 if self._active is None else self._active.cpu_time)

    def stopwatch(self) -> Callable[[], float]:
        """Return a function that returns the processor time, in seconds, that active workers have used since now.

        It does not depend on the load of the machine, up to the factor ``WALL_PER_CPU``.
        """
        used, start = self.cpu_time, time.monotonic()
        return lambda: max(self.cpu_time - used, (time.monotonic() - start) / WALL_PER_CPU)

    def __enter__(self) -> "WorkerPool":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], *rest: object) -> None:
        self.close()

    def start(self, stopped: Optional[Stop] = None) -> None:
        """Wait until a worker is ready; raises like a search, and NotReadyError after a stop."""
        self._run(lambda worker: worker.wait_until_ready(stopped), stopped)

    def close(self) -> None:
        """Kill all workers; later calls raise SolverError."""
        self._closed = True
        self._discard()
        self._discard_standby()

    # ---- Asking ------------------------------------------------------------------------------------------------------

    def ask(self, command: Message, log: Optional[History], stopped: Optional[Stop], idle: bool = False) -> Message:
        """Return the reply to ``command``, see :meth:`Worker.ask`; raises DroppedError if workers are lost."""
        return self._run(lambda worker: worker.ask(command, log, stopped, idle), stopped)

    def search(self, search: Search, stopped: Optional[Stop]) -> Message:
        """Return the reply to ``search``; the standby worker takes over if it has begun this search."""
        prefetched = self._standby is not None and self._standby.searches(search)
        if prefetched:
            self._exchange()

        def ask(worker: Worker) -> Message:
            """Ask a worker, or wait for it if it has begun."""
            if worker.searches(search):
                return worker.finish(stopped)
            return worker.ask(search.command, search.log, stopped)

        reply = self._run(ask, stopped)
        if self._active is not None and self._active.has_grown():
            self._replace()
        elif self._keeps_standby and not prefetched:
            with suppress(WorkerLostError):
                self._get_standby()
        return reply

    def prefetch(self, search: Search) -> bool:
        """Begin ``search`` in the standby worker; return whether it is searching or has the answer."""
        if self._closed or not self._keeps_standby:
            return False
        with suppress(WorkerLostError):
            begun = self._get_standby().search
            if begun is None or not begun.has_answer_of(search) or begun.log.plan != search.log.plan:
                if self._get_standby().has_grown():
                    self._discard_standby()
                self._get_standby().begin(search.command, search.log, search)
            return True
        return False

    def has_prefetched(self, search: Search, stopped: Optional[Stop] = None) -> bool:
        """Return whether the standby worker has the answer to ``search``; wait for it until ``stopped``."""
        return self._standby is not None and self._standby.has_answer(search, stopped)

    def _run(self, action: Callable[[Worker], T], stopped: Optional[Stop], retries: int = RETRIES) -> T:
        """Call ``action`` with the active worker, and again with another one if it is lost before a stop."""
        if self._closed:
            raise SolverError("the solver process has been closed")
        try:
            return action(self._get_active())
        except WorkerLostError as error:
            self._replace()
            if not retries or (stopped is not None and stopped()):
                raise DroppedError(f"{error}; the request was discarded") from None
            return self._run(action, stopped, retries - 1)
        except SolverError:
            raise
        except BaseException:  # a message may be half read
            self._discard()
            raise

    # ---- Workers -----------------------------------------------------------------------------------------------------

    def _get_active(self) -> Worker:
        """Return the active worker; if there is none, the standby worker becomes active. Raises WorkerLostError."""
        if self._active is None or not self._active.alive:
            self._discard()
            self._active, self._standby = self._get_standby(), None
            self._cpu_time -= self._active.cpu_time
        return self._active

    def _get_standby(self) -> Worker:
        """Return the standby worker, started if there is none; raises WorkerLostError."""
        if self._standby is None or not self._standby.alive:
            self._discard_standby()
            self._standby = Worker(self._load, self._patience, self._forked)
        return self._standby

    def _exchange(self) -> None:
        """Make the standby worker active and the active worker, if there is one, the standby worker."""
        self._active, self._standby = self._standby, self._active
        for worker, sign in ((self._active, -1), (self._standby, 1)):
            self._cpu_time += 0.0 if worker is None else sign * worker.cpu_time

    def _replace(self) -> None:
        """Replace the active worker; if that fails, the next call tries again."""
        self._discard()
        with suppress(WorkerLostError):
            self._get_active()

    def _discard(self) -> None:
        worker, self._active = self._active, None
        if worker is not None:
            self._cpu_time += worker.cpu_time
            worker.kill()

    def _discard_standby(self) -> None:
        worker, self._standby = self._standby, None
        if worker is not None:
            worker.kill()
