"""Results of updates, and messages about ignored or refused statements."""

import re
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Dict, FrozenSet, Iterable, Iterator, Tuple

import clingo

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.likeness import did_you_mean, most_similar
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.solving.stream_state import StreamState

Answer = FrozenSet[clingo.Symbol]

NOT_EXTERNAL = "Head {} has not been declared external. The entire rule will be ignored."
"""The warning about a statement of an update whose head the program does not declare."""


def is_ignored(head: clingo.Symbol, warnings: Iterable[str]) -> bool:
    """Return whether an update's ``warnings`` report that its statement with this ``head`` was ignored."""
    return any(NOT_EXTERNAL.format(head) in warning for warning in warnings)


_UNUSED = "No rule and no #external of the program mentions {}: the fact is accepted, but nothing depends on it{}."


class SolveOutcome(Enum):
    """How a search ended."""

    SATISFIABLE = "satisfiable"
    UNSATISFIABLE = "unsatisfiable"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True)
class SolveResult:
    """The result of an update.

    Attributes:
        outcome: satisfiable, unsatisfiable (up to the bound or permanently), or interrupted.
        answers: the shown atoms of each answer, in the order in which they were found.
        horizon: the horizon of the answers; without an answer, the last searched one, or the bound if the program is
            permanently unsatisfiable.
        step: k, the step of the update.
        warnings: ignored items, with reasons.
        permanent: whether the program is unsatisfiable for all further steps and externals.
        shortest: whether it is proven that no answer has a lower horizon, or the same horizon and a lower
            cost.
        predicted: success returns that leave the answer unchanged. An update with only these and the matching
            commitments needs no search.
        statistics: ``ground`` and ``solve``, seconds of wall time; ``needed``, seconds of processor time for the answer
            without its improvement.

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

    def until_horizon(self, program: ReactiveProgram) -> "SolveResult":
        """Return the result without the atoms of later steps, which a planner grounds although no plan needs them."""

        def is_in_time(atom: clingo.Symbol) -> bool:
            """Return whether an atom has a cycle up to the horizon or none, or is a fact of the stream."""
            time = program.time_of(atom)
            return time is None or time <= self.horizon or program.is_open_signature(atom)

        return replace(self, answers=tuple(frozenset(filter(is_in_time, answer)) for answer in self.answers))


@contextmanager
def refusing(messages: Messages, program: ReactiveProgram) -> Iterator[None]:
    """Convert errors of clingo to SolverError; ``messages`` is its log."""
    try:
        yield
    except RuntimeError as error:
        redefined = re.match("redefinition of atom <'(?P<atom>.*)',[0-9]+>", str(error))
        if redefined is not None:
            faults = program.redefinition_of(redefined.group("atom"))
        else:
            faults = messages.faults(error, program.parameter_at)
        raise SolverError("the update was refused: " + "\n".join(map(str, faults))) from None


def unused_facts(program: ReactiveProgram, state: StreamState) -> Iterator[str]:
    """Yield a warning for each predicate of the last update's facts that no rule of the program or stream uses."""
    known = set(program.open_signatures)
    for statement, _, number in state.timed_statements:
        if statement.head is None or statement.body or signature_of(statement.head) in known:
            continue
        signature = signature_of(statement.head)
        known.add(signature)
        if number == state.number:
            both = {signature, signature._replace(positive=not signature.positive)}
            bodies = (signature_of(one.atom) for rule in state.statements for one in rule.body)
            if both.isdisjoint(program.signatures) and both.isdisjoint(bodies):
                meant = did_you_mean(most_similar(signature, program.external_signatures))
                yield _UNUSED.format(signature, f" ({meant})" if meant else "")
