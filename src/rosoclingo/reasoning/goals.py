"""A client's goal, and its life as actionlib draws it."""

import math
from enum import Enum, IntEnum
from typing import Callable, Dict, Optional, Tuple

from clingo import Symbol

from rosoclingo.oclingo import ProgressionError, parse_term
from rosoclingo.reasoning.keywords import CANCEL, LONGEST, identifier_of, shortened
from rosoclingo.reasoning.records import Record, text_of


class GoalState(Enum):
    """actionlib's server-side states, by name."""

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
    """What can happen to a goal."""

    ACCEPT = "accept"
    CANCEL_REQUEST = "cancel request"
    REJECT = "reject"
    CANCEL = "cancel"
    SUCCEED = "succeed"
    ABORT = "abort"


class Outcome(IntEnum):
    """Why a goal ended; the numbers are those of ``ROSoClingo.action``."""

    SUCCEEDED = 0
    CANCELED = 1
    REJECTED = 2
    ABORTED = 3


#: The state diagram of actionlib's server: what is not listed is illegal.
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

#: States that a client's cancel leads to and that still need a terminal one.
CANCELLING = frozenset({GoalState.RECALLING, GoalState.PREEMPTING})

#: States before the program has said that it takes the goal.
UNDECIDED = frozenset({GoalState.PENDING, GoalState.RECALLING})

#: States that end a goal.
TERMINAL = frozenset(set(GoalState) - {state for state, _ in TRANSITIONS})

_ENDINGS = {
    Outcome.SUCCEEDED: GoalEvent.SUCCEED,
    Outcome.CANCELED: GoalEvent.CANCEL,
    Outcome.REJECTED: GoalEvent.REJECT,
    Outcome.ABORTED: GoalEvent.ABORT,
}


class TransitionError(RuntimeError):
    """An event that the goal's present state does not allow."""


class GoalError(ValueError):
    """A goal is rejected; the text is the reason that the client gets."""


#: The fields of a goal that its record has as they are.
RECORDED = ("request_cycle", "known", "refused", "overtaken", "together", "tries", "waits", "in_hand")


class Goal:
    """One client's goal.

    ``key`` is the client's handle (actionlib's goal id), ``term`` the goal as the program sees it, ``identifier`` its
    last argument. ``request_cycle`` is the cycle the request carries, None until it was fed. ``known`` tells whether
    the program has said something of it, ``refused`` whether that was that it rejects the goal. ``overtaken`` counts
    the goals that came later and have ended before it, ``together`` is how many goals a plan with it was for, at most;
    ``tries`` counts how often no plan was found in time for it alone; it is not fed before the time ``rests_until``.
    ``waits`` tells whether it is queued, ``in_hand`` that it could not be deferred.
    ``remark`` is the program's latest text about the accepted goal, empty for none.
    ``observer`` is called with the goal and the event after each transition.
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
        """The goal as all messages name it: its term."""
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
        """Record that an update in force carries the request, for ``cycle``."""
        self.request_cycle = cycle

    def forget(self) -> None:
        """Record that the program has forgotten the request."""
        self.request_cycle = None

    @property
    def cancelling(self) -> bool:
        """Whether a client has asked to cancel the goal, which has not ended yet."""
        return self.state in CANCELLING

    def record(self) -> Record:
        """Return the fields that :meth:`restore` needs; for a live goal."""
        rest = self.rests_until if math.isfinite(self.rests_until) else str(self.rests_until)
        fields = {name: getattr(self, name) for name in RECORDED}
        return {"term": text_of(self.term), "state": self.state.value, "rests_until": rest, **fields}

    def restore(self, record: Record) -> None:
        """Resume from a record of this goal."""
        self.state = GoalState(record["state"])
        self.rests_until = float(record["rests_until"])
        for name in RECORDED:
            setattr(self, name, record[name])

    def apply(self, event: GoalEvent) -> None:
        """Take a transition of the table; raises TransitionError."""
        try:
            self.state = TRANSITIONS[self.state, event]
        except KeyError:
            raise TransitionError(f"{self} is {self.state.value}: cannot {event.value}") from None
        self._observer(self, event)

    def accept(self) -> None:
        """The program takes the goal; nothing happens when it already did."""
        if self.state in UNDECIDED:
            self.apply(GoalEvent.ACCEPT)

    def end(self, outcome: Outcome, message: str) -> None:
        """End the goal; raises TransitionError when it has ended already.

        Success and failure pass through acceptance, as actionlib wants it, and a goal once accepted is aborted
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
    """Return the goal term of a client's text; raises GoalError with the reason when it is none."""
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
