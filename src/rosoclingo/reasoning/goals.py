"""Goals of clients, with the state machine of actionlib's server."""

import math
from enum import Enum, IntEnum
from typing import Callable, Dict, Optional, Tuple

from clingo import Symbol

from rosoclingo.oclingo import ProgressionError, parse_term
from rosoclingo.reasoning.keywords import CANCEL, LONGEST, identifier_of, shortened
from rosoclingo.reasoning.records import Record, text_of


class GoalState(Enum):
    """The states of actionlib's server."""

    PENDING = "pending"
    RECALLING = "recalling"
    ACTIVE = "active"
    PREEMPTING = "preempting"
    RECALLED = "recalled"
    REJECTED = "rejected"
    PREEMPTED = "preempted"
    SUCCEEDED = "succeeded"
    ABORTED = "aborted"


class GoalEvent(Enum):
    """The events of actionlib's state machine."""

    ACCEPT = "accept"
    CANCEL_REQUEST = "cancel request"
    REJECT = "reject"
    CANCEL = "cancel"
    SUCCEED = "succeed"
    ABORT = "abort"


class Outcome(IntEnum):
    """The outcome of a goal, as numbered in ``ROSoClingo.action``."""

    SUCCEEDED = 0
    CANCELED = 1
    REJECTED = 2
    ABORTED = 3


#: The state machine of actionlib's server; transitions that are not listed are illegal.
TRANSITIONS: Dict[Tuple[GoalState, GoalEvent], GoalState] = {
    (GoalState.PENDING, GoalEvent.ACCEPT): GoalState.ACTIVE,
    (GoalState.PENDING, GoalEvent.REJECT): GoalState.REJECTED,
    (GoalState.PENDING, GoalEvent.CANCEL_REQUEST): GoalState.RECALLING,
    (GoalState.PENDING, GoalEvent.CANCEL): GoalState.RECALLED,
    (GoalState.RECALLING, GoalEvent.ACCEPT): GoalState.PREEMPTING,
    (GoalState.RECALLING, GoalEvent.REJECT): GoalState.REJECTED,
    (GoalState.RECALLING, GoalEvent.CANCEL): GoalState.RECALLED,
    (GoalState.ACTIVE, GoalEvent.CANCEL_REQUEST): GoalState.PREEMPTING,
    (GoalState.ACTIVE, GoalEvent.CANCEL): GoalState.PREEMPTED,
    (GoalState.ACTIVE, GoalEvent.SUCCEED): GoalState.SUCCEEDED,
    (GoalState.ACTIVE, GoalEvent.ABORT): GoalState.ABORTED,
    (GoalState.PREEMPTING, GoalEvent.CANCEL): GoalState.PREEMPTED,
    (GoalState.PREEMPTING, GoalEvent.SUCCEED): GoalState.SUCCEEDED,
    (GoalState.PREEMPTING, GoalEvent.ABORT): GoalState.ABORTED,
}

#: The states of a goal that a client has cancelled and that has not ended.
CANCELLING = frozenset({GoalState.RECALLING, GoalState.PREEMPTING})

#: The states of a goal that the program has not accepted yet.
UNDECIDED = frozenset({GoalState.PENDING, GoalState.RECALLING})

#: The states of goals that have ended.
TERMINAL = frozenset(set(GoalState) - {state for state, _ in TRANSITIONS})

_ENDINGS = {
    Outcome.SUCCEEDED: GoalEvent.SUCCEED,
    Outcome.CANCELED: GoalEvent.CANCEL,
    Outcome.REJECTED: GoalEvent.REJECT,
    Outcome.ABORTED: GoalEvent.ABORT,
}


class TransitionError(RuntimeError):
    """The present state of the goal does not allow the event."""


class GoalError(ValueError):
    """A goal is rejected; the text is the reason that the client gets."""


#: The fields of a goal that its record contains unchanged.
RECORDED = ("request_cycle", "known", "refused", "overtaken", "together", "tries", "waits", "in_hand")


class Goal:
    """A goal of a client. ``observer`` is called with the goal and the event after each transition.

    Attributes:
        key: the client's handle, which is actionlib's goal id.
        term: the goal as a term of the program.
        identifier: the last argument of the term.
        request_cycle: the cycle of the request, None until it is fed.
        known: whether the program has given it a status.
        refused: whether the program has rejected it.
        overtaken: the number of newer goals that have ended before it.
        together: the maximum number of goals in a plan with it.
        tries: the number of searches for it alone that found no plan in time.
        rests_until: the time before which it is not fed, in seconds.
        waits: whether it is queued.
        in_hand: whether it could not be deferred.
        message: the reason of its end.
        remark: the program's latest text about the accepted goal, empty for none.

    """

    def __init__(self, key: str, term: Symbol, observer: "Callable[[Goal, GoalEvent], None]") -> None:
        self.key = key
        self.term = term
        self.identifier: Symbol = term.arguments[-1]
        self.state = GoalState.PENDING
        self.request_cycle: Optional[int] = None
        self.outcome: Optional[Outcome] = None
        self.known = False
        self.refused = False
        self.overtaken = self.together = 0
        self.tries = 0
        self.waits = self.in_hand = False
        self.rests_until = float("-inf")
        self.message = self.remark = ""
        self._observer = observer

    def __str__(self) -> str:
        """The term of the goal, shortened for messages."""
        return shortened(str(self.term))

    @property
    def live(self) -> bool:
        """Whether the goal has not ended."""
        return self.state not in TERMINAL

    @property
    def fed(self) -> bool:
        """Whether the program knows the request."""
        return self.request_cycle is not None

    def feed(self, cycle: int) -> None:
        """Record that the solver has accepted the request, for ``cycle``."""
        self.request_cycle = cycle

    def forget(self) -> None:
        """Record that the program no longer has the request."""
        self.request_cycle = None

    @property
    def cancelling(self) -> bool:
        """Whether a client has cancelled the goal and it has not ended yet."""
        return self.state in CANCELLING

    def record(self) -> Record:
        """Return the fields of a live goal for :meth:`restore`."""
        rest = self.rests_until if math.isfinite(self.rests_until) else str(self.rests_until)
        fields = {name: getattr(self, name) for name in RECORDED}
        return {"term": text_of(self.term), "state": self.state.value, "rests_until": rest, **fields}

    def restore(self, record: Record) -> None:
        """Restore the fields of a record of this goal."""
        self.state = GoalState(record["state"])
        self.rests_until = float(record["rests_until"])
        for name in RECORDED:
            setattr(self, name, record[name])

    def apply(self, event: GoalEvent) -> None:
        """Change the state by an event; raises TransitionError if the event is illegal."""
        try:
            self.state = TRANSITIONS[self.state, event]
        except KeyError:
            raise TransitionError(f"{self} is {self.state.value}: cannot {event.value}") from None
        self._observer(self, event)

    def accept(self) -> None:
        """Accept the goal, unless it has been accepted before."""
        if self.state in UNDECIDED:
            self.apply(GoalEvent.ACCEPT)

    def end(self, outcome: Outcome, message: str) -> None:
        """End the goal; raises TransitionError if it has ended already.

        As actionlib requires, a goal is accepted before it succeeds or is aborted, and an accepted goal is aborted
        instead of rejected.
        """
        if not self.live:
            raise TransitionError(f"{self} has ended: it is {self.state.value}")
        if outcome is Outcome.REJECTED and self.state not in UNDECIDED:
            outcome = Outcome.ABORTED
        if outcome in (Outcome.SUCCEEDED, Outcome.ABORTED):
            self.accept()
        self.outcome, self.message = outcome, message
        self.apply(_ENDINGS[outcome])


def read_goal(text: str) -> Symbol:
    """Return the goal term of a client's text; raises GoalError if the text is not a valid goal."""
    if len(text) > LONGEST:
        raise GoalError(f"'{shortened(text)}' is too long for a goal: write at most {LONGEST} characters")
    try:
        term = parse_term(text)
    except ProgressionError as error:
        raise GoalError(f"'{shortened(text)}' cannot be a goal: {error.message}") from error
    if identifier_of(term) is None:
        raise GoalError(f"'{shortened(text)}' names no goal: write a function whose last argument identifies it")
    if term.name == CANCEL:
        raise GoalError(f"'{shortened(text)}' is the core's own request: cancel the goal itself instead")
    return term
