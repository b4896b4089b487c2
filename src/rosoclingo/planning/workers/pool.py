"""The worker processes of one program.

clingo cannot be interrupted while it grounds, and a program can exhaust the memory. So the pool replaces workers that
ignore a stop, end or crash. Workers have no state except caches, so this costs only time.
"""

import time
from contextlib import suppress
from typing import Any, Callable, Optional, Type

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.question import Stop, never
from rosoclingo.planning.workers.protocol import WorkerReply
from rosoclingo.planning.workers.worker import SolverWorker, WorkerLostError, WorkerRequest

PATIENCE = 2.0
"""Seconds of wall time after a stop until the worker is killed."""

RETRIES = 1
"""Number of times that a command is repeated after it crashed a worker."""

WALL_PER_CPU = 20
"""Seconds of wall time that count as one second of processor time; this limits the wait for a sleeping worker."""


class WorkerPool:
    """The active worker of one program, and a standby worker that prefetches and takes over.

    Not thread-safe. The workers end with :meth:`close` or with this process.

    A stop ends a search with the outcome INTERRUPTED; the update stays accepted. A worker that has not grounded the
    program for the update stops between two pieces. clingo does not react to a stop while it grounds a piece; after
    ``patience`` seconds, the pool kills the worker. In both cases, and after repeated crashes, the update is dropped
    and DroppedError is raised. While a worker loads the program, a stop has no effect.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        *,
        patience: float = PATIENCE,
        standby: bool = False,
        fork: bool = False,
        **options: Any,
    ) -> None:
        """Start a worker for ``program``; :meth:`start` waits until it has loaded the program.

        Args:
            program: the reactive logic program.
            patience: seconds of wall time after a stop until the worker is killed.
            standby: whether to use a standby worker, which is started after the first answer.
            fork: whether workers are forks of this process. Forks start much faster, but this process must have no
                threads.
            options: options of the solver, plain values; ``shortest`` selects :class:`PlanSolver` rather than
                :class:`ReactiveSolver`. ``growth`` is the number of bytes by which a worker can grow after its first
                search (default: 32 MB, or as much as it used then if that is more). A worker that grows more is
                replaced, but not before it has searched often.

        """
        self._start_worker = lambda: SolverWorker(program, options, patience, fork)
        self._keeps_standby = standby
        self._active: Optional[SolverWorker] = None
        self._standby: Optional[SolverWorker] = None
        self._closed = False
        self._cpu_time = 0.0  # of former active workers, minus what the active one used as a standby worker
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
        """Seconds of processor time that active workers have used, without loading the program."""
        return self._cpu_time + (0.0 if self._active is None else self._active.cpu_time)

    def stopwatch(self) -> Callable[[], float]:
        """Start a stopwatch; return a function that returns the processor time (s) used by active workers since then.

        This time does not depend on the load of the machine, up to the factor :data:`WALL_PER_CPU`.
        """
        used, start = self.cpu_time, time.monotonic()
        return lambda: max(self.cpu_time - used, (time.monotonic() - start) / WALL_PER_CPU)

    def __enter__(self) -> "WorkerPool":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], *rest: object) -> None:
        self.close()

    def start(self, stopped: Stop = never) -> None:
        """Wait until a worker is ready, or until ``stopped``; raises like a search."""
        self.ask(WorkerRequest("ping"), stopped, idle=True)

    def close(self) -> None:
        """Kill all workers; later calls raise SolverError."""
        self._closed = True
        self._end(self._activate(None))
        self._end(self._standby)

    # ---- Requests ----------------------------------------------------------------------------------------------------

    def ask(self, request: WorkerRequest, stopped: Stop = never, idle: bool = False) -> WorkerReply:
        """Return the reply to ``request``, see :meth:`SolverWorker.ask`.

        The standby worker takes over if it has begun this request. Raises DroppedError if workers are lost.
        """
        if self._closed:
            raise SolverError("the solver process has been closed")
        losses = 0
        while True:
            try:
                return self._ask(request, stopped, idle)
            except WorkerLostError as error:
                self._replace()
                losses += 1
                if losses > RETRIES or stopped():
                    raise DroppedError(f"{error}; the request was discarded") from None
            except SolverError:
                raise
            except BaseException:  # a message can be half read
                self._end(self._activate(None))
                raise

    def _ask(self, request: WorkerRequest, stopped: Stop, idle: bool) -> WorkerReply:
        worker, prefetched = self._standby, True
        if worker is not None and worker.has_begun(request):
            self._standby = self._activate(worker)
        else:
            worker, prefetched = self._get_active(), False

        def attended() -> bool:
            """Return whether to stop; let the standby worker begin its next command."""
            if self._standby is not None:
                self._standby.is_busy()
            return stopped()

        reply = worker.ask(request, attended, idle)
        if not worker.is_usable:
            self._replace()  # now, as the standby is idle
        elif self._keeps_standby and not (prefetched or idle):
            with suppress(WorkerLostError):
                self._get_standby()
        return reply

    def prefetch(self, request: WorkerRequest) -> bool:
        """Begin ``request`` in the standby worker; return whether it is searching or has the answer."""
        if self._closed or not self._keeps_standby:
            return False
        if self._standby is not None and self._standby.has_begun(request, same_plan=True):
            return True
        with suppress(WorkerLostError):
            self._get_standby().begin(request)
            return True
        return False

    def has_prefetched(self, request: WorkerRequest, stopped: Stop) -> bool:
        """Return whether the standby worker has the answer to ``request``; wait for it until ``stopped``."""
        return self._standby is not None and self._standby.has_answer(request, stopped)

    def has_begun(self, request: WorkerRequest) -> bool:
        """Return whether the active worker has begun ``request``."""
        return self._active is not None and self._active.has_begun(request)

    # ---- Workers -----------------------------------------------------------------------------------------------------

    def _get_active(self) -> SolverWorker:
        """Return the active worker; if there is none, the standby worker becomes active. Raises WorkerLostError."""
        if self._active is None or not self._active.is_usable:
            self._end(self._activate(None))
            worker, self._standby = self._get_standby(), None
            self._activate(worker)
            return worker
        return self._active

    def _get_standby(self) -> SolverWorker:
        """Return the standby worker, started if there is none; raises WorkerLostError."""
        if self._standby is None or not self._standby.is_usable:
            self._end(self._standby)
            self._standby = None  # remains None if the start fails
            self._standby = self._start_worker()
        return self._standby

    def _activate(self, worker: Optional[SolverWorker]) -> Optional[SolverWorker]:
        """Make ``worker`` the active worker; return the former one."""
        former, self._active = self._active, worker
        self._cpu_time += 0.0 if former is None else former.cpu_time
        self._cpu_time -= 0.0 if worker is None else worker.cpu_time
        return former

    def _replace(self) -> None:
        """Replace the active worker; if that fails, the next call tries again."""
        self._end(self._activate(None))
        with suppress(WorkerLostError):
            self._get_active()

    @staticmethod
    def _end(worker: Optional[SolverWorker]) -> None:
        if worker is not None:
            worker.kill()
