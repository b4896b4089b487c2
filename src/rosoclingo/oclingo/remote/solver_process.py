"""Reactive solvers in a process of their own, so that they can be ended whatever they do.

clingo can't be interrupted while it grounds, and a program may need more memory than there is. The solvers of a
:class:`SolverProcess` answer as a ``ReactiveSolver`` does; where their process does
not heed a stop, or crashes, it is replaced by one that reads their logs, without searching.
"""

import time
import weakref
from collections import deque
from contextlib import suppress
from typing import Any, Callable, Deque, Iterator, List, Optional, Type, TypeVar

from rosoclingo.oclingo.errors import DroppedError, NotReadyError, ProgramError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.remote.child import Growth, Stopped, WorkerLostError, WorkerProcess
from rosoclingo.oclingo.remote.place import Place
from rosoclingo.oclingo.remote.preparation import Spare, Subject
from rosoclingo.oclingo.remote.process_solver import ProcessSolver
from rosoclingo.oclingo.remote.wire import (
    Message,
    faults_from_message,
    plan_to_message,
    program_to_message,
)
from rosoclingo.oclingo.solving.stream_log import Checkpoint, StreamLog, entry_to_message

T = TypeVar("T")

POLL_PREPARING = 0.02
"""Seconds of wall time between two looks at the stop request while a child takes a program or a log.

That is often done in a moment, and would be asked for again.
"""

GRACE = 1.0
"""Seconds of wall time that a grounding may go on after a stop request before it is dropped between two pieces."""

PATIENCE = 2.0
"""Seconds of wall time that the process is given to heed a stop request before it is killed."""

BEHIND = 16  # updates that were foreseen which the child is told of though it is at something else

LOAD = 20
"""Seconds of wall time that count for one second of work: a solver that does not work at all is not waited for."""


class SolverProcess:
    """A child process with solvers of one reactive logic program.

    Not thread-safe. A child is running from the start on; :meth:`close` or the end of this process ends it.

    A stop request ends a search with outcome INTERRUPTED, the update stays in force. A short grounding comes to its
    end before; one that takes more than ``grace`` seconds is dropped between two pieces, and where the child heeds
    nothing, as clingo can't be interrupted in a piece, it is killed after ``patience`` seconds. Then the update is
    dropped as a whole and DroppedError raised. The same holds where the child crashes. Another child then takes the
    states; a stop meanwhile raises NotReadyError and lets it go on with that.

    With ``spare`` that other child is kept ready: once an answer is there it is started, has the program loaded and
    waits. One at a time is started so.
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
        """Start a child for ``program``; it is ready some tenths of a second later, :meth:`start` waits for that.

        Args:
            program: the reactive logic program.
            models: how many answers to compute for an update, 0 for all.
            patience: seconds of wall time that the child has to heed a stop request.
            grace: those of them in which a grounding may come to its end.
            spare: whether to keep another child ready.
            options: what else :class:`~rosoclingo.oclingo.solving.solver.ReactiveSolver` takes; plain values.

        """
        self._patience, self._grace = patience, grace
        self._keeps_spare = spare
        self._program: Message = {
            "do": "load",
            "program": program_to_message(program),
            "options": dict(options, models=models),
        }
        self.plans = bool(options.get("shortest"))  # else no search begins with a plan, and to find one takes time
        self._numbers: Iterator[int] = iter(range(2**62))
        self._left: List[int] = []
        self._preparing: Deque[Optional[Place]] = deque()  # what the child is at: the program (None) or a solver
        self._child: Optional[WorkerProcess] = None
        self._spare = Spare(self._new_child)
        self._closed = False
        self._growth = Growth()  # looked at where the child's log is shortened
        self._worked = 0.0  # processor time of the children that were
        self._respawn()

    @property
    def pid(self) -> Optional[int]:
        """Process id of the child, None where there is none."""
        return None if self._child is None else self._child.pid

    @property
    def spare_pid(self) -> Optional[int]:
        """Process id of the child that is kept ready, None where there is none."""
        return self._spare.pid

    @property
    def prepares(self) -> bool:
        """Whether the child that is kept ready is at work."""
        return self._spare.works

    @property
    def reached(self) -> int:
        """The last step that a search under way has ground, as far as the child has told."""
        return 0 if self._child is None else self._child.reached

    @property
    def worked(self) -> float:
        """Seconds of processor time that the children have used up to now, but for the one that is kept ready."""
        return self._worked + (0.0 if self._child is None else self._child.worked)

    def stopwatch(self) -> Callable[[], float]:
        """Return what tells how many seconds of processor time the solvers have worked since now.

        A machine that has other things to do changes nothing; but it is taken to be at most ``LOAD`` times slower.
        """
        worked, start = self.worked, time.monotonic()
        return lambda: max(self.worked - worked, (time.monotonic() - start) / LOAD)

    def __enter__(self) -> "SolverProcess":
        return self

    def __exit__(self, kind: Optional[Type[BaseException]], *rest: object) -> None:
        self.close()

    def start(self, stopped: Optional[Stopped] = None) -> None:
        """Wait until the child can solve; raises NotReadyError where ``stopped`` came first, else as a search does."""
        self._guarded(lambda: self._prepare(stopped))

    def solver(self) -> ProcessSolver:
        """Return a solver to which nothing has been fed; the child forgets it when it is no longer referred to."""
        return ProcessSolver(self)

    def close(self) -> None:
        """End the child; nothing can be asked any more."""
        self._closed = True
        self._discard()
        self._spare.discard()

    def place(self) -> Place:
        """Return a place for a solver in the child, free again when it is no longer referred to."""
        place = Place(next(self._numbers))
        weakref.finalize(place, self._left.append, place.number).atexit = False
        return place

    def ask(
        self, place: Place, log: StreamLog, update: Optional[StreamUpdate], stopped: Optional[Stopped]
    ) -> List[Message]:
        """Have the solver at ``place`` read ``log``, take ``update`` and search; return the child's reply.

        Where that was prepared there may be more: of searches without an update that followed.
        """
        replies = [] if update is None else self._prepared_for(Subject(place, log, update, None), stopped)
        if not replies:
            text = None if update is None else str(update)
            replies = [self.have(place, log, {"do": "update", "update": text}, stopped)]
            if self._keeps_spare:
                self._spare.have()
        return replies

    def prepare(self, subject: Subject) -> bool:
        """Have the child that is kept ready find an answer that may be asked for; it then takes the other's place.

        Tell whether it does so now.
        """
        return not self._closed and self._keeps_spare and self._spare.prepare(subject)

    def has_prepared(self, subject: Subject) -> bool:
        """Whether the child that is kept ready has found that answer, so that nobody has to wait for it."""
        return self._spare.has_prepared(subject)

    def _prepared_for(self, subject: Subject, stopped: Optional[Stopped]) -> List[Message]:
        """Go on with the child that has prepared for that; return what it has found, nothing where there is none."""
        prepared = self._spare.taken(subject)
        if prepared is None:
            return []
        self._discard()
        self._have(prepared.child, 0)
        patience = self._grace, self._patience
        found = self._guarded(lambda: prepared.take(stopped, patience), subject.place, subject.log)
        subject.place.child, subject.place.read = (self._child if found else None), subject.log
        return found

    def have(
        self, place: Place, log: StreamLog, command: Message, stopped: Optional[Stopped], leaves: bool = False
    ) -> Message:
        """Have the solver at ``place`` read what is new in ``log`` and do a ``command``; return the child's reply.

        What ``leaves`` nothing behind but a better plan is not waited for once it is ``stopped``: there is no reply.
        """

        def ask() -> Message:
            """Tell the child what its solver has not read of the log yet, and the command."""
            self._prepare(stopped, place, log, command.get("update"))
            assert self._child is not None
            self._child.send({**command, **self._about(place, place.unread(log))})
            return self._child.reply(stopped, (self._grace, self._patience), leaves)

        reply = self._guarded(ask, place, log)
        place.read, place.ahead = log, leaves and not reply
        if "refused" in reply:
            raise (DroppedError if reply["dropped"] else SolverError)(reply["refused"])
        return reply

    def follow(self, place: Place, log: StreamLog) -> None:
        """Have the solver at ``place`` read an update that was foreseen, without waiting for that."""
        child = self._child
        if child is None or len(self._preparing) >= BEHIND or not child.alive or not self._reads(place, log):
            return  # the next command comes with what is unread
        with suppress(WorkerLostError):  # it sees to that, too
            plan = {"plan": plan_to_message(log.plan)} if place.ahead else {}
            child.send({"do": "follow", **plan, **self._about(place, place.unread(log))})
            place.read, place.ahead = log, False
            self._preparing.append(place)

    def has_read(self, place: Place, log: StreamLog) -> None:
        """Note that the solver at ``place`` is where ``log`` leads; a child that has grown goes at a checkpoint."""
        place.read = log
        if isinstance(log.entry, Checkpoint):
            self._renew(place, log)

    def _renew(self, place: Place, log: StreamLog) -> None:
        """Replace a child that has grown by one that reads the short ``log``, while nothing is asked.

        clingo never forgets a term: every step of a stream leaves some behind, in the process as a whole.
        """
        if self._growth.is_too_much(0 if self._child is None else self._child.memory):
            self._respawn(place, log)

    def _guarded(self, action: Callable[[], T], *solver: Any) -> T:
        """Do ``action``; where the child is lost have another one under way, which reads the solver's log again."""
        if self._closed:
            raise SolverError("the solver process has been closed")
        try:
            return action()
        except WorkerLostError as error:
            self._respawn(*solver)
            raise DroppedError(f"{error}; what it was asked for was dropped") from None
        except SolverError:
            raise
        except BaseException:  # a reply may still be on its way
            self._discard()
            raise

    def _prepare(
        self,
        stopped: Optional[Stopped],
        place: Optional[Place] = None,
        log: Optional[StreamLog] = None,
        coming: Optional[str] = None,
    ) -> Message:
        """Wait until the child has the program, and a solver at ``place`` that has read ``log`` or the most of it."""
        if self._child is None or not self._child.alive:
            self._discard()
            self._spawn()
        if place is not None and log is not None and not self._reads(place, log):
            self._rebuild(place, log, coming)
        reply: Message = {}
        while self._preparing:
            reply = self._prepared(stopped)
            prepared = self._preparing.popleft()
            if "faults" in reply:
                raise ProgramError(faults_from_message(reply))
            if "refused" in reply and prepared is not None:
                prepared.child = None
                if prepared is place:
                    raise SolverError(f"the solver can't be rebuilt: {reply['refused']}")
        return reply

    def _prepared(self, stopped: Optional[Stopped]) -> Message:
        """Wait for the reply to what the child prepares, which goes on with it on a stop."""
        assert self._child is not None
        while True:
            reply = self._child.receive(POLL_PREPARING)
            if reply is not None:
                return reply
            if stopped is not None and stopped():
                raise NotReadyError("stopped before the solver was ready: nothing was solved, send it again")

    def _reads(self, place: Place, log: StreamLog) -> bool:
        """Whether the child has a solver at ``place`` that has read nothing but what is in ``log``."""
        return place.child is self._child and place.read is not None and log.since(place.read) is not None

    def _rebuild(self, place: Place, log: StreamLog, coming: Optional[str] = None) -> None:
        """Have the child make a solver that reads the whole log."""
        assert self._child is not None
        entries = [entry_to_message(one) for one in log.entries]
        plan = plan_to_message(log.plan)
        self._child.send({"do": "rebuild", "coming": coming, "plan": plan, **self._about(place, entries)})
        place.child, place.read = self._child, log
        self._preparing.append(place)

    def _about(self, place: Place, entries: List[Message]) -> Message:
        """Say which solver a command is for, what it is to read before, and which ones nobody refers to any more."""
        left = [self._left.pop() for _ in range(len(self._left))]
        return {"solver": place.number, "log": entries, "left": left}

    def _spawn(self) -> None:
        """Have a child, the one that was kept ready if there is one; it answers once it has the program."""
        spare = self._spare.taken()
        if spare is None:
            self._have(self._new_child(), 1)
        else:
            self._have(spare.child, spare.release())

    def _have(self, child: WorkerProcess, loading: int) -> None:
        """Go on with a ``child``, which first gives so many other replies; what it has worked before is not counted."""
        self._child, self._growth = child, Growth()
        self._worked -= child.worked
        self._preparing.clear()
        self._preparing.extend([None] * loading)

    def _new_child(self) -> WorkerProcess:
        try:
            child = WorkerProcess()
        except OSError as error:
            raise WorkerLostError(f"no solver process can be started: {error}") from None
        child.send(self._program)
        return child

    def _respawn(self, place: Optional[Place] = None, log: Optional[StreamLog] = None) -> None:
        """Have another child under way for the next call; where that fails, the next call tries again."""
        self._discard()
        with suppress(WorkerLostError):
            self._spawn()
            if place is not None and log is not None:
                self._rebuild(place, log)

    def _discard(self) -> None:
        child, self._child = self._child, None
        if child is not None:
            self._worked += child.worked
            child.kill()
