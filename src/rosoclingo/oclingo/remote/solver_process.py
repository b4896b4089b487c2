"""Reactive solvers in a process of their own, so that they can be ended whatever they do.

clingo can't be interrupted while it grounds, and a program may need more memory than there is. The solvers of a
:class:`SolverProcess` answer as a ``ReactiveSolver`` does; where their process does
not heed a stop, or crashes, it is replaced by one that reads their logs, without searching.
"""

import time
import weakref
from collections import deque
from contextlib import suppress
from dataclasses import replace
from typing import Any, Callable, Deque, FrozenSet, Iterator, List, Optional, Type

import clingo

from rosoclingo.oclingo.errors import DroppedError, NotReadyError, ProgramError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.remote.child import Stopped, WorkerLostError, WorkerProcess
from rosoclingo.oclingo.remote.place import Place
from rosoclingo.oclingo.remote.wire import (
    Message,
    faults_from_message,
    plan_to_message,
    program_to_message,
    question_to_message,
    result_from_message,
    verdict_from_message,
)
from rosoclingo.oclingo.solving.inquiry import Verdict
from rosoclingo.oclingo.solving.solver import ForeseeingSolver, SolveResult
from rosoclingo.oclingo.solving.stream_log import Checkpoint, StreamLog, Taken, entry_to_message

POLL_PREPARING = 0.02
"""Seconds of wall time between two looks at the stop request while a child takes a program or a log.

That is often done in a moment, and would be asked for again.
"""

GRACE = 1.0
"""Seconds of wall time that a grounding may go on after a stop request before it is dropped between two pieces."""

PATIENCE = 2.0
"""Seconds of wall time that the process is given to heed a stop request before it is killed."""

BEHIND = 16  # updates that were foreseen which the child is told of though it is at something else

GROWTH = 32 * 2**20
"""Bytes by which a child may grow before it is replaced; by half of what it began with, where that is more."""

LOAD = 20
"""Seconds of wall time that count for one second of work: a solver that does not work at all is not waited for."""


class ProcessSolver(ForeseeingSolver):
    """Solves a reactive logic program under a stream of updates, in a child process.

    The methods are those of :class:`~rosoclingo.oclingo.solving.solver.ReactiveSolver`; not thread-safe.
    """

    def __init__(self, process: "SolverProcess") -> None:
        """Make a solver in ``process``, to which nothing has been fed; that does not wait for the process."""
        super().__init__()
        self._process = process
        self._place = process.place()

    def solve(self, stopped: Optional[Stopped] = None) -> SolveResult:
        """Search without an update."""
        return self._search(None, stopped)

    def update(self, update: StreamUpdate, stopped: Optional[Stopped] = None) -> SolveResult:
        """Take ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError where the update as a whole can't be taken, DroppedError where the child had to be ended;
        the log is then as it was before. An interrupted search leaves the update in force. What was foreseen is
        answered at once, whatever the child is at, which takes it while the caller goes on.
        """
        result = self._go_on(update)
        if result is not None:
            self._process.follow(self._place, self._log)
        else:
            result = self._search(update, stopped)
        return replace(result, warnings=update.warnings + result.warnings)

    def improve(self, stopped: Optional[Stopped] = None) -> Optional[SolveResult]:
        """Look for a shorter plan until there is one, ``stopped`` or nothing is left to try; raises as updates do.

        A stop is passed on, and not waited for.
        """
        if self._log.plan is None or self._log.plan.shortest:
            return None
        command, reply = {"do": "improve", "plan": plan_to_message(self._log.plan)}, {}
        with suppress(NotReadyError):
            reply = self._process.have(self._place, self._log, command, stopped, leaves=True)
        if not reply:
            return None
        result = result_from_message(reply)
        self._log.plan = result.plan
        self._has_answered(result)
        return result

    def inquire(
        self,
        update: StreamUpdate,
        doubted: FrozenSet[clingo.Symbol],
        untold: FrozenSet[clingo.Symbol],
        stopped: Optional[Stopped] = None,
    ) -> Verdict:
        """Tell whether ``update`` would have an answer, had ``untold`` never been told; raises as updates do."""
        question = question_to_message(update, doubted, untold)
        return verdict_from_message(self._process.have(self._place, self._log, question, stopped))

    def _search(self, update: Optional[StreamUpdate], stopped: Optional[Stopped]) -> SolveResult:
        reply = self._process.ask(self._place, self._log, update, stopped)
        result = result_from_message(reply)
        self._log = self._log.then(Taken(update, reply["grounded"]))
        if self._process.plans:
            self._log.plan = result.plan or self._log.plan
        if reply["checkpoint"] is not None:
            self._log = self._log.then(Checkpoint(message=reply["checkpoint"])).cut()
        self._has_answered(result)
        self._process.has_read(self._place, self._log)
        return result


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
        self._spare: Optional[WorkerProcess] = None
        self._closed = False
        self._first_memory: Optional[int] = None  # that of the child when its log was shortened first
        self._worked = 0.0  # processor time of the children that were
        self._respawn()

    @property
    def pid(self) -> Optional[int]:
        """Process id of the child, None where there is none."""
        return None if self._child is None else self._child.pid

    @property
    def spare_pid(self) -> Optional[int]:
        """Process id of the child that is kept ready, None where there is none."""
        return None if self._spare is None else self._spare.pid

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
        self._discard_spare()

    def place(self) -> Place:
        """Return a place for a solver in the child, free again when it is no longer referred to."""
        place = Place(next(self._numbers))
        weakref.finalize(place, self._left.append, place.number).atexit = False
        return place

    def ask(self, place: Place, log: StreamLog, update: Optional[StreamUpdate], stopped: Optional[Stopped]) -> Message:
        """Have the solver at ``place`` read ``log``, take ``update`` and search; return the child's reply."""
        text = None if update is None else str(update)
        reply = self.have(place, log, {"do": "update", "update": text}, stopped)
        self._have_spare()
        return reply

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
        memory = 0 if self._child is None else self._child.memory
        if self._first_memory is None:
            self._first_memory = memory
        elif memory > self._first_memory + max(GROWTH, self._first_memory // 2):
            self._respawn(place, log)

    def _guarded(self, action: Callable[[], Message], *solver: Any) -> Message:
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
                raise NotReadyError("the solver still takes again what led here; ask again")

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
        self._first_memory = None
        self._preparing.clear()
        self._child, self._spare = self._spare, None
        if self._child is None or not self._child.alive:
            self._discard()
            self._child = self._new_child()
        self._preparing.append(None)

    def _new_child(self) -> WorkerProcess:
        try:
            child = WorkerProcess()
        except OSError as error:
            raise WorkerLostError(f"no solver process can be started: {error}") from None
        child.send(self._program)
        return child

    def _have_spare(self) -> None:
        """Start a child to be kept ready; it loads the program while the caller goes on."""
        if not self._keeps_spare or (self._spare is not None and self._spare.alive):
            return
        self._discard_spare()
        with suppress(WorkerLostError):  # there is none then, until the next answer
            self._spare = self._new_child()

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

    def _discard_spare(self) -> None:
        spare, self._spare = self._spare, None
        if spare is not None:
            spare.kill()
