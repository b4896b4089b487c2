"""Which argument of an atom is its time: the one that heads in the parts of steps write as ``t + c``."""

from typing import Dict, Iterator, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.look_back import time_offset
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.signatures import atom_terms, term_signature
from rosoclingo.oclingo.progression.terms import Signature


def time_positions(parts: Sequence[Part], constants: Dict[str, clingo.Symbol]) -> Dict[Signature, int]:
    """Return the position of the time in the arguments of predicates, and of terms that are shown.

    Of several arguments that all heads write as times it is the last one; where heads disagree there is none. It is the
    same under classical negation. Tuples have the empty name. ``constants`` are the program's.
    """
    found: Dict[Signature, Set[int]] = {}
    for part in parts:
        for term in _heads(part) if part.parameter else ():
            signature, arguments = _parted(term)
            timed = {n for n, one in enumerate(arguments) if time_offset(one, part.parameter, constants) is not None}
            if timed:
                found[signature] = timed & found.get(signature, timed)
    return {signature: max(positions) for signature, positions in found.items() if positions}


def _heads(part: Part) -> Iterator[Node]:
    """Yield what the statements of a part define, declare or show."""
    for _, one in part.atoms:
        if one.head:
            yield one.term
    for statement in part.statements:
        if statement.ast_type == ASTType.ShowTerm:
            for term in atom_terms(statement.term):
                if _bare(term).ast_type == ASTType.Function:
                    yield term


def _bare(term: Node) -> Node:
    """Return a term without the sign of classical negation."""
    return term.argument if term.ast_type == ASTType.UnaryOperation else term


def _parted(term: Node) -> Tuple[Signature, Sequence[Node]]:
    bare = _bare(term)
    return term_signature(bare), bare.arguments if bare.ast_type == ASTType.Function else ()
