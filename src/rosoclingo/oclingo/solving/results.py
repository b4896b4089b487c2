"""What comes of an update."""

import re
from dataclasses import dataclass, field
from enum import Enum
from typing import Dict, FrozenSet, Optional, Tuple

import clingo

from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram

Answer = FrozenSet[clingo.Symbol]


class SolveOutcome(Enum):
    """How solving an update ended."""

    SATISFIABLE = "satisfiable"
    UNSATISFIABLE = "unsatisfiable"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True)
class SolveResult:
    """Outcome of an update.

    Attributes:
        outcome: satisfiable; unsatisfiable up to the bound or for good; or interrupted.
        answers: the shown atoms of each answer, in the order in which they were found.
        horizon: that of the answers, else the last one that was searched; if nothing can make the program satisfiable
            any more, the greatest one that was asked for, as though all up to it had been searched.
        step: k, the step of the update.
        warnings: what was ignored and why.
        permanent: True if no further step and no external can make the program satisfiable.
        shortest: True if it is proven that no answer has a lesser horizon.
        foreseen: success returns that leave the answer unchanged. An update with only these and the matching
            commitments needs no search.
        statistics: seconds of wall time spent in ``ground`` and ``solve``; and seconds of processor time that were
            ``needed`` for an answer, less what went on improving it.

    """

    outcome: SolveOutcome
    answers: Tuple[Answer, ...]
    horizon: int
    step: int
    warnings: Tuple[str, ...] = ()
    permanent: bool = False
    statistics: Dict[str, float] = field(default_factory=dict, compare=False)
    shortest: bool = False
    foreseen: FrozenSet[clingo.Symbol] = frozenset()


def refusal(error: RuntimeError, messages: Optional[Messages], program: ReactiveProgram) -> str:
    """Return what clingo's ``error`` means for the update that was fed."""
    redefined = re.match("redefinition of atom <'(?P<atom>.*)',[0-9]+>", str(error))
    if redefined is not None:
        faults = program.redefinition_of(redefined.group("atom"))
    elif messages is not None:
        faults = messages.faults(error, program.parameter_at)
    else:
        return f"the update was refused: {error}"
    return "the update was refused: " + "\n".join(map(str, faults))
