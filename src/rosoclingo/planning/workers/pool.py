"""The workers of one program: processes that can be ended whatever they do.

clingo can't be interrupted while it grounds, and a program may need more memory than there is. A worker that does not
heed a stop, or crashes, is replaced by another one; as workers have no state but caches, that costs nothing but time.
"""

import time
from contextlib import suppress
from typing import Any, Callable, List, Optional, Type, TypeVar

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.planning.history import Checkpoint, History
from rosoclingo.planning.workers.child import Stopped, WorkerLostError
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.planning.workers.wire import Message, program_to_message
from rosoclingo.planning.workers.worker import Prefetch, Worker

T = TypeVar("T")

GRACE = 1.0
"""Seconds of wall time that a grounding may go on after a stop request before it is dropped between two pieces."""

PATIENCE = 2.0
"""Seconds of wall time that a worker is given to heed a stop request before it is killed."""

RETRIES = 1
"""So many times what was asked of a worker that crashed is asked of another one."""

LOAD = 20
"""Seconds of wall time that count for one second of work: a solver that does not work at all is not waited for."""


class WorkerPool:
    """The active worker of one program, and a standby that prefetches and takes over.

    Not thread-safe. A worker is running from the start on; :meth:`close` or the end of this process ends it.

    A stop request ends a search with outcome INTERRUPTED, the update stays in force. A grounding that takes more than
    ``grace`` seconds is dropped between two pieces, and if the worker heeds nothing, as clingo can't be interrupted in
    a piece, it is killed after ``patience`` seconds. Then the update is dropped as a whole and DroppedError raised. If
    a worker crashes another one is asked; if that crashes too DroppedError is raised. While a worker loads the program
    a stop raises NotReadyError.
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
            patience: seconds of wall time that a worker has to heed a stop request.
            grace: those of them in which a grounding may come to its end.
            spare: whether to keep a standby, which is started once there is an answer.
            options: ``shortest`` for the solver of plans, else it is the incremental one, and what else that solver
                takes; plain values.

        """
        self._patience = grace, patience
        self._keeps_standby = spare
        told = {"program": program_to_message(program), "options": dict(options, models=models)}
        self._program: Message = {"do": "load", **told}
        self.plans = bool(options.get("shortest"))  # else no search begins with a plan, and to find one takes time
        self._active: Optional[Worker] = None
        self._standby: Optional[Worker] = None
        self._closed = False
        self._worked = 0.0  # processor time of the active workers that were
        self._replace()

    @property
    def pid(self) -> Optional[int]:
        """Process id of the active worker, None if there is none."""
        return None if self._active is None else self._active.child.pid

    @property
    def spare_pid(self) -> Optional[int]:
        """Process id of the standby, None if there is none."""
        return None if self._standby is None else self._standby.child.pid

    @property
    def prepares(self) -> bool:
        """Whether the standby is at work."""
        with suppress(WorkerLostError):
            return self._standby is not None and self._standby.is_busy
        return False

    @property
    def reached(self) -> int:
        """The last step that a search under way has ground, as far as the worker has told."""
        return 0 if self._active is None else self._active.child.reached

    @property
    def worked(self) -> float:
        """Seconds of processor time that the active workers have used up to now."""
        return self._worked + (0.0 if self._active is None else self._active.child.worked)

    def stopwatch(self) -> Callable[[], float]:
        """Return what tells how many seconds of processor time the workers have worked since now.

        A machine that has other things to do changes nothing; but it is taken to be at most ``LOAD`` times slower.
        """
        worked, start = self.worked, time.monotonic()
        return lambda: max(self.worked - worked, (time.monotonic() - start) / LOAD)

    def __enter__(self) -> "WorkerPool":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], *rest: object) -> None:
        self.close()

    def start(self, stopped: Optional[Stopped] = None) -> None:
        """Wait until a worker can solve; raises NotReadyError if ``stopped`` came first, else as a search does."""
        self._guarded(lambda: self._have().wait_until_loaded(stopped))

    def solver(self) -> ProcessSolver:
        """Return a solver to which nothing has been fed."""
        return ProcessSolver(self)

    def close(self) -> None:
        """End all workers; nothing can be asked any more."""
        self._closed = True
        self._discard()
        self._discard_standby()

    # ---- Asking ------------------------------------------------------------------------------------------------------

    def search(self, log: History, update: Optional[StreamUpdate], stopped: Optional[Stopped]) -> List[Message]:
        """Return the reply to ``update`` after ``log``, or those that were prefetched: more than one if it improved."""
        replies = [] if update is None else self._prefetched(Prefetch(log, update), stopped)
        if not replies:
            text = None if update is None else str(update)
            replies = [self.ask(log, {"do": "update", "update": text}, stopped)]
            if self._keeps_standby:
                self._have_standby()
        return replies

    def ask(self, log: History, command: Message, stopped: Optional[Stopped], leaves: bool = False) -> Message:
        """Return the reply of the active worker to a ``command`` about ``log``; see :meth:`Worker.ask`."""
        retries = 0 if leaves else RETRIES
        return self._guarded(lambda: self._have().ask(log, command, stopped, self._patience, leaves), stopped, retries)

    def came_to(self, log: History) -> None:
        """Note that the last command has led to ``log``; a worker that has grown is replaced at a checkpoint."""
        if self._active is not None:
            self._active.note(log)
            if isinstance(log.entry, Checkpoint) and self._active.has_grown:
                self._replace()

    def prefetch(self, wanted: Prefetch) -> bool:
        """Have the standby find the answer to what may be asked for; tell whether it is at that, or has it."""
        if self._closed or not self._keeps_standby:
            return False
        self._have_standby()
        with suppress(WorkerLostError):
            if self._standby is not None and self._standby.has_grown and not self._standby.is_about(wanted):
                self._discard_standby()
                self._have_standby()
            if self._standby is not None:
                self._standby.prefetch(wanted)
                return self._standby.is_about(wanted)
        return False

    def has_prefetched(self, wanted: Prefetch) -> bool:
        """Whether the standby has that answer, so that nobody has to wait for it."""
        with suppress(WorkerLostError):
            return self._standby is not None and self._standby.has(wanted)
        return False

    def _prefetched(self, wanted: Prefetch, stopped: Optional[Stopped]) -> List[Message]:
        """Return what the standby has found, which becomes the active worker; nothing if it was not about that."""
        standby = self._standby
        if standby is None or not standby.child.alive or not standby.is_about(wanted):
            return []
        self._standby = None
        self._discard()
        self._activate(standby)
        return self._guarded(lambda: standby.fetch(stopped, self._patience))

    # ---- Workers -----------------------------------------------------------------------------------------------------

    def _have(self) -> Worker:
        """Return the active worker; raises WorkerLostError if none can be started."""
        if self._active is None or not self._active.child.alive:
            self._discard()
            self._activate(self._next())
        assert self._active is not None
        return self._active

    def _next(self) -> Worker:
        """Return the standby, or a new worker."""
        standby, self._standby = self._standby, None
        if standby is not None and standby.child.alive:
            return standby
        if standby is not None:
            standby.child.kill()
        return Worker(self._program)

    def _activate(self, worker: Worker) -> None:
        """Have ``worker`` be the active one; what it has worked before is not counted."""
        self._active = worker
        self._worked -= worker.child.worked

    def _have_standby(self) -> None:
        """Start a standby if there is none; it loads the program while the caller goes on."""
        if self._standby is None or not self._standby.child.alive:
            self._discard_standby()
            with suppress(WorkerLostError):  # there is none then, until the next time
                self._standby = Worker(self._program)

    def _guarded(self, action: Callable[[], T], stopped: Optional[Stopped] = None, retries: int = 0) -> T:
        """Do ``action``; if the worker is lost have another one under way, which does it if there was no stop."""
        if self._closed:
            raise SolverError("the solver process has been closed")
        try:
            return action()
        except WorkerLostError as error:
            self._replace()
            if retries <= 0 or (stopped is not None and stopped()):
                raise DroppedError(f"{error}; what it was asked for was dropped") from None
            return self._guarded(action, stopped, retries - 1)
        except SolverError:
            raise
        except BaseException:  # a reply may still be on its way
            self._discard()
            raise

    def _replace(self) -> None:
        """Have another worker under way; if that fails the next call tries again."""
        self._discard()
        with suppress(WorkerLostError):
            self._activate(self._next())

    def _discard(self) -> None:
        worker, self._active = self._active, None
        if worker is not None:
            self._worked += worker.child.worked
            worker.child.kill()

    def _discard_standby(self) -> None:
        worker, self._standby = self._standby, None
        if worker is not None:
            worker.child.kill()
