"""Results of updates, and messages about ignored or refused statements."""

import re
from dataclasses import dataclass, field
from enum import Enum
from typing import Dict, FrozenSet, Iterable, Optional, Tuple

import clingo

from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.likeness import asked, likely
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import Statement

Answer = FrozenSet[clingo.Symbol]

NOT_EXTERNAL = "Head {} has not been declared external. The entire rule will be ignored."
"""The warning about a statement of an update whose head the program does not declare."""


def is_ignored(head: clingo.Symbol, warnings: Iterable[str]) -> bool:
    """Return whether an update's ``warnings`` report that its statement with this ``head`` was ignored."""
    return any(NOT_EXTERNAL.format(head) in warning for warning in warnings)


_UNUSED = "No rule and no #external of the program mentions {}: it takes it, but nothing depends on it{}."


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
        shortest: True if it is proven that no answer has a lesser horizon or, with the same, a lesser cost.
        predicted: success returns that leave the answer unchanged. An update with only these and the matching
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
    predicted: FrozenSet[clingo.Symbol] = frozenset()


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


def unused_fact(program: ReactiveProgram, head: clingo.Symbol, statements: Iterable[Statement]) -> Optional[str]:
    """Return what to tell of a fact that neither ``program`` nor the ``statements`` of its stream have any use for."""
    signature = signature_of(head)
    both = {signature, signature._replace(positive=not signature.positive)}
    if both & program.signatures or any(signature_of(one.atom) in both for rule in statements for one in rule.body):
        return None
    meant = asked(likely(signature, program.external_signatures))
    return _UNUSED.format(signature, f" ({meant})" if meant else "")
