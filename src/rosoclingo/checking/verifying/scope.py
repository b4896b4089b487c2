"""The scope of a verification: the possible events, the limits, and the kinds of defects."""

from enum import Enum
from typing import Mapping, NamedTuple, Sequence, Tuple

from clingo import Symbol

from rosoclingo.checking.extension import Kinds

SECONDS = 60.0
"""The default limit of processor time."""


class DefectKind(Enum):
    """The kinds of defects, as named on the command line."""

    NO_ANSWER = "no-answer"
    FORBIDDEN = "forbidden"
    REPEATED = "repeated"
    FAILURE_AS_SUCCESS = "failure-as-success"
    NEVER_ENDED = "never-ended"
    PUT_OFF = "put-off"
    MALFORMED = "malformed"


class VerifyLimits(NamedTuple):
    """Limits of a verification.

    Attributes:
        events: the number of events of a stream.
        together: the number of events between two updates.
        steps: the number of steps of a plan.
        late: the number of cycles that a fact can be late.
        early: the number of cycles that a fact can be early.
        all_plans: whether to try all shortest plans, or only the one that the solver finds.

    """

    events: int = 3
    together: int = 2
    steps: int = 20
    late: int = 2
    early: int = 1
    all_plans: bool = True


class EventSelection(NamedTuple):
    """The events that a user selects; empty fields are derived from the program.

    Attributes:
        goals: the goals to send.
        facts: the names of the facts to send.
        reasons: further failure reasons, by interface.
        most: the greatest number of goals of each kind, and of facts of each predicate.
        kinds: likely requests of each kind.

    """

    goals: Tuple[Symbol, ...] = ()
    facts: Tuple[str, ...] = ()
    reasons: Mapping[str, Sequence[Symbol]] = {}
    most: int = 2
    kinds: Kinds = ()
