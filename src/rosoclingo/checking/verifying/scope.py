"""What a verification is asked: what may come, how far to look, and which faults count."""

from enum import Enum
from typing import Mapping, NamedTuple, Sequence, Tuple

from clingo import Symbol

from rosoclingo.checking.more import Kinds

SECONDS = 60.0
"""Processor time that it may take."""


class Kind(Enum):
    """What can be wrong, in words."""

    NO_ANSWER = "no-answer"
    FORBIDDEN = "forbidden"
    REPEATED = "repeated"
    FAILURE_AS_SUCCESS = "failure-as-success"
    NEVER_ENDED = "never-ended"
    PUT_OFF = "put-off"
    MALFORMED = "malformed"


class Limits(NamedTuple):
    """What is tried.

    Attributes:
        events: of a stream.
        together: of them between two updates.
        steps: that a plan may have.
        late: cycles that a fact may be late.
        early: cycles that a fact may be early.
        all_plans: whether all shortest plans are tried, or the one that the solver finds.

    """

    events: int = 3
    together: int = 2
    steps: int = 20
    late: int = 2
    early: int = 1
    all_plans: bool = True


class Wanted(NamedTuple):
    """What a user has said of what may come; what is empty is read from the program.

    Attributes:
        goals: what may be asked for.
        facts: predicates of the facts that may be told.
        reasons: further reasons, by interface.
        most: goals of each kind, and facts of each predicate, at most.
        kinds: requests of each kind that are likely.

    """

    goals: Tuple[Symbol, ...] = ()
    facts: Tuple[str, ...] = ()
    reasons: Mapping[str, Sequence[Symbol]] = {}
    most: int = 2
    kinds: Kinds = ()
