"""The time argument of predicates: the argument that heads of cumulative and volatile parts write as ``t + c``."""

from typing import Dict, Iterator, Sequence, Set

from clingo.ast import ASTType

from rosoclingo.oclingo.program.look_back import time_offsets
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.signatures import atom_terms, signature_and_arguments, without_sign
from rosoclingo.oclingo.progression.terms import Signature


def time_positions(parts: Sequence[Part]) -> Dict[Signature, int]:
    """Return the position of the time argument of predicates and of shown terms.

    If all heads write several arguments as times, the last one counts; if heads disagree, there is no time argument.
    Classical negation makes no difference. Tuples have the empty name.
    """
    found: Dict[Signature, Set[int]] = {}
    for part in parts:
        for term in _heads(part) if part.parameter else ():
            signature, arguments = signature_and_arguments(without_sign(term))
            timed = set(time_offsets(arguments, part.parameter, part.constants))
            if timed:
                found[signature] = timed & found.get(signature, timed)
    return {signature: max(positions) for signature, positions in found.items() if positions}


def _heads(part: Part) -> Iterator[Node]:
    """Yield the terms that the statements of a part define, declare or show."""
    yield from (one.term for one in part.atoms if one.head)
    for statement in part.statements:
        if statement.ast_type == ASTType.ShowTerm:
            yield from (one for one in atom_terms(statement.term) if without_sign(one).ast_type == ASTType.Function)
