"""An answer that is had before its update comes: by the child that is kept ready, while the other one goes on.

What is prepared is what the solver would be asked for, after the same log. So it is the answer where that very update
comes, and of no use where anything else does.
"""

from contextlib import suppress
from typing import Callable, List, NamedTuple, Optional, Tuple

from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.remote.child import Growth, Stopped, WorkerLostError, WorkerProcess
from rosoclingo.oclingo.remote.place import Place
from rosoclingo.oclingo.remote.wire import Message, plan_to_message
from rosoclingo.oclingo.solving.solver import SolveOutcome
from rosoclingo.oclingo.solving.stream_log import Plan, StreamLog, entry_to_message

PAUSE = 0.1
"""Seconds of wall time that go by first, lest all be for nothing where actions take no time."""


class Subject(NamedTuple):
    """What a preparation is about: the solver, what it has taken, and what may come.

    Where it ``improves``, the plan is shortened until it is asked for.
    """

    place: Place
    log: StreamLog
    update: StreamUpdate
    plan: Optional[Plan]
    improves: bool = False


class Preparation:
    """What is prepared in a child that has been sent the program, and nothing else, by others.

    Attributes:
        child: the child.

    """

    def __init__(self, child: WorkerProcess) -> None:
        self.child = child
        self._subject: Optional[Subject] = None  # what it is about, None where nothing is prepared
        self._stale = 1  # replies to come that are of no use: that to the program is the first
        self._due = 0  # replies to come
        self._replies: List[Message] = []
        self._growth, self._grown = Growth(), False

    @property
    def is_under_way(self) -> bool:
        """Whether the child has not come to an end with what it was asked for."""
        self._receive()
        return bool(self._due or self._stale)

    def begin(self, subject: Subject) -> bool:
        """Prepare for ``subject``; where that is under way, for the plan that has become better meanwhile.

        Returns False where the child has grown too large for anything else. Raises WorkerLostError where it has gone.
        """
        self._receive()
        if self.is_about(subject):
            self._go_on(subject.plan)
            return True
        if self._grown:
            return False
        self._leave()
        if self._stale <= 1:  # else one is left by and by, and another waits
            self._send(subject)
        return True

    @property
    def has_answer(self) -> bool:
        """Whether a child that is alive has answered, if only to become better."""
        self._receive()
        decided = {SolveOutcome.SATISFIABLE.value, SolveOutcome.UNSATISFIABLE.value}
        return self.child.alive and any(one.get("outcome") in decided for one in self._replies)

    def is_about(self, subject: Subject) -> bool:
        """Whether it would give the answer that is asked for."""
        mine = self._subject
        if mine is None or mine.place is not subject.place or mine.update != subject.update:
            return False
        return mine.log is subject.log or mine.log.key == subject.log.key

    def release(self) -> int:
        """Prepare nothing any more; return how many replies of no use are to come."""
        self._leave()
        return self._stale

    def take(self, stopped: Optional[Stopped], patience: Tuple[float, float]) -> List[Message]:
        """Wait for the answer, but for no better one; return the replies that it takes, none where it was refused.

        Raises WorkerLostError.
        """
        self._receive()
        if not self._replies:
            self.child.send({"do": "now"})
        while self._stale or not self._replies:
            self._take(self.child.reply(stopped, patience))
        while self._due:
            self._take(self.child.reply(lambda: True, patience))
        return [] if any("outcome" not in one for one in self._replies) else self._replies

    def _send(self, subject: Subject) -> None:
        place, log, update, plan, improves = subject
        entries, text = [entry_to_message(one) for one in log.entries], str(update)
        told = {"solver": place.number, "log": entries, "plan": plan_to_message(plan), "improves": improves}
        self.child.send({"do": "prepare", "update": text, "coming": text, "pause": PAUSE, **told})
        self._subject, self._due, self._replies = subject, 1 + improves, []

    def _go_on(self, plan: Optional[Plan]) -> None:
        """Once there is an answer, look for one that goes on from a ``plan`` that has become better."""
        if self._due or plan is None or self._subject is None or plan == self._subject.plan:
            return
        self._subject = self._subject._replace(plan=plan)
        last = self._replies[-1]
        if last.get("outcome") == SolveOutcome.SATISFIABLE.value and plan.horizon + 1 < last["horizon"]:
            told = {"solver": self._subject.place.number, "log": [], "plan": plan_to_message(plan)}
            self.child.send({"do": "update", "update": None, **told})
            self._due += 1

    def _leave(self) -> None:
        if self._due:
            self.child.send({"do": "interrupt"})
        self._subject, self._stale, self._due, self._replies = None, self._stale + self._due, 0, []

    def _receive(self) -> None:
        """Take the replies that are there."""
        while self._stale or self._due:
            reply = self.child.receive(0.0)
            if reply is None:
                break
            self._take(reply)

    def _take(self, reply: Message) -> None:
        if "outcome" in reply:
            self._grown = self._growth.is_too_much(self.child.memory)
        if self._stale:
            self._stale -= 1
        else:
            self._due -= 1
            self._replies += [reply] if reply else []  # there is none where a plan got no shorter


class Spare:
    """A child that is kept ready to take the place of another, and prepares meanwhile what may come; or none."""

    def __init__(self, start: Callable[[], WorkerProcess]) -> None:
        """Have none; ``start`` makes one that loads the program, and raises WorkerLostError where it can't."""
        self._start = start
        self._one: Optional[Preparation] = None

    @property
    def pid(self) -> Optional[int]:
        """Process id of the child, None where there is none."""
        return None if self._one is None else self._one.child.pid

    @property
    def works(self) -> bool:
        """Whether the child prepares something, or loads the program."""
        try:
            return self._one is not None and self._one.is_under_way
        except WorkerLostError:
            return False

    def have(self) -> None:
        """Start a child where there is none; it loads the program while the caller goes on."""
        if self._one is None or not self._one.child.alive:
            self.discard()
            with suppress(WorkerLostError):  # there is none then, until the next time
                self._one = Preparation(self._start())

    def prepare(self, subject: Subject) -> bool:
        """Have the answer prepared to what may come, which nothing waits for; tell whether that is done now."""
        self.have()
        with suppress(WorkerLostError):
            if self._one is not None and not self._one.begin(subject):
                self.discard()
        return self._one is not None and self._one.is_about(subject)

    def has_prepared(self, subject: Subject) -> bool:
        """Whether the answer to what may come is there."""
        with suppress(WorkerLostError):
            return self._one is not None and self._one.has_answer and self._one.is_about(subject)
        return False

    def taken(self, subject: Optional[Subject] = None) -> Optional[Preparation]:
        """Return the child and have it no more, None where there is none, or none that has prepared ``subject``."""
        one = self._one
        if one is None or not one.child.alive or not (subject is None or one.is_about(subject)):
            return None
        self._one = None
        return one

    def discard(self) -> None:
        """End the child."""
        one, self._one = self._one, None
        if one is not None:
            one.child.kill()
