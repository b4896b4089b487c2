"""Goals of clients, with the state machine of actionlib's server."""

from dataclasses import dataclass
from enum import Enum, IntEnum
from typing import Callable, Dict, Optional, Tuple

from clingo import Symbol

from rosoclingo.oclingo import ProgressionError, parse_term
from rosoclingo.reasoning.keywords import CANCEL, LONGEST, identifier_of, shortened


class GoalState(Enum):
    """The states of actionlib's server, in the order of ``actionlib_msgs/GoalStatus``."""

    PENDING = "pending"
    ACTIVE = "active"
    PREEMPTED = "preempted"
    SUCCEEDED = "succeeded"
    ABORTED = "aborted"
    REJECTED = "rejected"
    PREEMPTING = "preempting"
    RECALLING = "recalling"
    RECALLED = "recalled"

    @property
    def number(self) -> int:
        """The number of the state in ``actionlib_msgs/GoalStatus``."""
        return list(GoalState).index(self)


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
CANCELLING = (GoalState.RECALLING, GoalState.PREEMPTING)

#: The states of a goal that the program has not accepted yet.
UNDECIDED = (GoalState.PENDING, GoalState.RECALLING)

#: The states of goals that have ended.
TERMINAL = tuple(one for one in GoalState if one not in {state for state, _ in TRANSITIONS})

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


@dataclass(eq=False)
class Goal:
    """A goal of a client; the arguments of the constructor are its persisted state.

    Attributes:
        key: the client's handle, which is actionlib's goal id.
        term: the goal as a term of the program.
        state: the state of actionlib's server.
        request_cycle: the cycle of the request, None until it is fed.
        known: whether the program has given it a status.
        refused: whether the program has rejected it.
        overtaken: the number of newer goals that have ended before it.
        together: the maximum number of goals in a plan with it.
        tries: the number of searches for it alone that found no plan in time.
        waits: whether it is queued.
        in_hand: whether it could not be deferred.
        identifier: the last argument of the term.
        outcome: the outcome of a goal that has ended.
        message: the reason of its end.
        remark: the program's latest text about the accepted goal, empty for none.
        observer: called with the goal and the event after each transition.

    """

    key: str
    term: Symbol
    state: GoalState = GoalState.PENDING
    request_cycle: Optional[int] = None
    known: bool = False
    refused: bool = False
    overtaken: int = 0
    together: int = 0
    tries: int = 0
    waits: bool = False
    in_hand: bool = False

    def __post_init__(self) -> None:
        """Set the derived attributes."""
        self.identifier: Symbol = self.term.arguments[-1]
        self.outcome: Optional[Outcome] = None
        self.message = self.remark = ""
        self.observer: Callable[[Goal, GoalEvent], None] = lambda goal, event: None

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

    @property
    def cancelling(self) -> bool:
        """Whether a client has cancelled the goal and it has not ended yet."""
        return self.state in CANCELLING

    def apply(self, event: GoalEvent) -> None:
        """Change the state by an event; raises TransitionError if the event is illegal."""
        try:
            self.state = TRANSITIONS[self.state, event]
        except KeyError:
            raise TransitionError(f"{self} is {self.state.value}: cannot {event.value}") from None
        self.observer(self, event)

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
