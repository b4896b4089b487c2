"""One worker: a child process that has the program and answers commands about histories."""

from typing import List, NamedTuple, Optional, Tuple

from rosoclingo.oclingo.errors import DroppedError, NotReadyError, ProgramError, SolverError
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.planning.history import History
from rosoclingo.planning.workers.child import Growth, Stopped, WorkerLostError, WorkerProcess
from rosoclingo.planning.workers.known_histories import Told
from rosoclingo.planning.workers.wire import Message, faults_from_message

POLL_LOADING = 0.02
"""Seconds of wall time between two looks at the stop request while a child takes the program."""

PAUSE = 0.1
"""Seconds of wall time that go by before something is prefetched, lest all be for nothing if actions take no time."""

Patience = Tuple[float, float]
"""Seconds of wall time after a stop until a command is dropped, and until the worker is given up."""


class Prefetch(NamedTuple):
    """A question that can come next: ``update`` after ``log``.

    If it ``improves``, the plan that is found is shortened until it is asked for.
    """

    log: History
    update: StreamUpdate
    improves: bool = False

    def is_like(self, other: "Prefetch") -> bool:
        """Whether both have the same answer."""
        same = self.log is other.log or self.log.key == other.log.key
        return same and self.update == other.update

    def is_worse(self, other: "Prefetch") -> bool:
        """Whether the plan of the ``other`` is a shorter one."""
        mine, theirs = self.log.plan, other.log.plan
        return mine is not None and theirs is not None and theirs.horizon < mine.horizon


class Worker:
    """A child process with the program; it knows histories, and is asked about them or prefetches an answer.

    Attributes:
        child: the process.
        came_to: the number of the history to which the last command led.

    """

    def __init__(self, program: Message) -> None:
        """Start a child that loads the ``program``; raises WorkerLostError if that can't be done."""
        try:
            self.child = WorkerProcess()
        except OSError as error:
            raise WorkerLostError(f"no solver process can be started: {error}") from None
        self.child.send(program)
        self._told, self._growth = Told(), Growth()
        self._loading = True
        self._stale = 0  # replies to come that are of no use
        self._prefetch: Optional[Prefetch] = None
        self._due = 0  # replies to come about it
        self._replies: List[Message] = []
        self.came_to = 0

    # ---- Asking ------------------------------------------------------------------------------------------------------

    def wait_until_loaded(self, stopped: Optional[Stopped]) -> None:
        """Wait for the program to be loaded.

        Raises NotReadyError if ``stopped`` came first, which lets it go on, ProgramError and WorkerLostError.
        """
        while self._loading or self._stale:
            reply = self.child.receive(POLL_LOADING)
            if reply is not None:
                self._take(reply)
            elif stopped is not None and stopped():
                raise NotReadyError("stopped before the solver was ready: nothing was solved, send it again")

    def ask(
        self, log: History, command: Message, stopped: Optional[Stopped], patience: Patience, leaves: bool = False
    ) -> Message:
        """Return the reply to a ``command`` about ``log``.

        What ``leaves`` nothing behind but a better plan is not waited for once it is ``stopped``: the reply is empty.
        Raises SolverError for what is refused, WorkerLostError if the worker does not heed a stop or has ended.
        """
        self.leave()
        self.wait_until_loaded(stopped)
        self.child.send(self._about(log, command))
        reply = self.child.reply(stopped, patience, leaves)
        if "refused" in reply:
            raise (DroppedError if reply["dropped"] else SolverError)(reply["refused"])
        return reply

    def note(self, log: History) -> None:
        """Note that the last command has led to ``log``."""
        self._told.note(log, self.came_to)

    def _about(self, log: History, command: Message) -> Message:
        told = self._told.telling(log)
        self.came_to = self._told.next_number()
        return {**command, **told, "after": self.came_to}

    @property
    def has_grown(self) -> bool:
        """Whether it holds much more memory than at first: clingo never forgets a term."""
        return self._growth.is_too_much(self.child.memory)

    # ---- Prefetching -------------------------------------------------------------------------------------------------

    @property
    def is_busy(self) -> bool:
        """Whether it loads the program or prefetches something."""
        self._receive()
        return self._loading or bool(self._stale or self._due)

    def prefetch(self, wanted: Prefetch) -> None:
        """Find the answer to what may be asked for; nothing waits for it."""
        self._receive()
        if self._prefetch is not None and self._prefetch.is_like(wanted) and not self._prefetch.is_worse(wanted):
            return
        self.leave()
        if self._stale:
            return  # it is to be asked again when what it is at has ended
        told = {"do": "prefetch", "update": str(wanted.update), "pause": PAUSE, "improves": wanted.improves}
        self.child.send(self._about(wanted.log, told))
        self._prefetch, self._due, self._replies = wanted, 1 + wanted.improves, []

    def is_about(self, wanted: Prefetch) -> bool:
        """Whether it prefetches that, or has."""
        return self._prefetch is not None and self._prefetch.is_like(wanted)

    def has(self, wanted: Prefetch) -> bool:
        """Whether it has the answer to that."""
        self._receive()
        decided = any(one.get("outcome") in ("satisfiable", "unsatisfiable") for one in self._replies)
        return self.child.alive and self.is_about(wanted) and decided

    def fetch(self, stopped: Optional[Stopped], patience: Patience) -> List[Message]:
        """Wait for what is prefetched, but for no better plan; return the replies, none if it was refused."""
        self._receive()
        if not self._replies:
            self.child.send({"do": "now"})
        while self._loading or self._stale or not self._replies:
            self._take(self.child.reply(stopped, patience))
        while self._due:
            self._take(self.child.reply(lambda: True, patience))
        replies, self._replies, self._prefetch = [one for one in self._replies if one], [], None
        return [] if any("outcome" not in one for one in replies) else replies

    def leave(self) -> None:
        """Prefetch nothing any more."""
        if self._due:
            self.child.send({"do": "interrupt"})
        self._prefetch, self._stale, self._due, self._replies = None, self._stale + self._due, 0, []

    def _receive(self) -> None:
        """Take the replies that are there."""
        while self._loading or self._stale or self._due:
            reply = self.child.receive(0.0)
            if reply is None:
                break
            self._take(reply)

    def _take(self, reply: Message) -> None:
        if self._loading:
            self._loading = False
            if "faults" in reply:
                raise ProgramError(faults_from_message(reply))
        elif self._stale:
            self._stale -= 1
        else:
            self._due -= 1
            self._replies.append(reply)  # an empty one if a plan got no shorter
