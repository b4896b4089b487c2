"""The situations of the core within a cycle, and the rows of its table of responses."""

from enum import Enum
from typing import Any, Callable, NamedTuple, Optional

from rosoclingo.oclingo import SolveOutcome, SolveResult
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.reasoning.input_feeder import Batch


class Situation(Enum):
    """The situation of the core. The loop over the table ends with SETTLED."""

    DUE = "a cycle is due"
    REFUSED = "the solver refuses the update"
    DROPPED = "the solver did not accept the update in time"
    UNHANDLED = "the program cannot handle a failure"
    PLAN = "there is a plan"
    NO_PLAN = "there is no plan"
    TIMEOUT = "no answer was found in time"
    DISTURBED = "an arrival has interrupted the search"
    SETTLED = "the cycle has begun, or the core waits"


#: The situation after a search, by its outcome.
SITUATION_AFTER = {
    SolveOutcome.SATISFIABLE: Situation.PLAN,
    SolveOutcome.UNSATISFIABLE: Situation.NO_PLAN,
    SolveOutcome.INTERRUPTED: Situation.TIMEOUT,
}


class State(NamedTuple):
    """The situation of the core, and its details.

    Attributes:
        situation: the rows of the table that apply.
        batch: the update of the cycle.
        now: the time in seconds.
        result: the result of the last search.
        accepted: whether the solver has accepted the update.
        deferred: whether goals were deferred after this result.
        no_plan: the original stream without a plan, if its observations have been repaired.
        why: why there is no plan.

    """

    situation: Situation
    batch: Batch
    now: float
    result: SolveResult = SolveResult(SolveOutcome.INTERRUPTED, (), 0, 0)
    accepted: bool = False
    deferred: bool = False
    no_plan: Optional[Stream] = None
    why: str = ""

    @property
    def settled(self) -> "State":
        """The state at the end of the loop."""
        return self._replace(situation=Situation.SETTLED)


class Response(NamedTuple):
    """One row of the table: a step of the core in a situation.

    Attributes:
        situation: the situation in which the row applies.
        text: the step in words.
        step: a function of the core and the state. It returns the next state, or None if the step does not apply or
            does not help.

    """

    situation: Situation
    text: str
    step: Callable[[Any, State], Optional[State]]
