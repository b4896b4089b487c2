"""Induction over the steps: a proof that longer plans do not exist either.

The base case: all plans of some length violate the rules on their last step. The induction step: from any state, two
successive steps that violate these rules at the first also violate them at the second. States are arbitrary sets of
reachable atoms, see :mod:`~rosoclingo.planning.explaining.reach`, so the proof is sound, and incomplete.
"""

from typing import Iterable, List, Optional, Set

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.parts import Occurrence
from rosoclingo.oclingo.program.survey import OWN
from rosoclingo.planning.explaining.atom_patterns import names_of
from rosoclingo.planning.explaining.named_rules import RuleKind
from rosoclingo.planning.explaining.reach import Reach, mentions
from rosoclingo.planning.explaining.relaxed_program import BROKEN, WHOLE, RelaxedProgram

_NUMBER = clingo.SymbolType.Number
_STEP = 1_000_000  # beyond the steps of all facts

_INDUCTION = """
__oclingo_ends :- {broken}(N,{step},V), __oclingo_end(N).
:- not __oclingo_ends.
:- {broken}(N,{step}+1,V), __oclingo_end(N).
"""


def excludes_longer_plans(program: RelaxedProgram, rules: Iterable[int], reach: Reach, last: int) -> bool:
    """Return whether plans beyond step ``last`` provably violate the ``rules`` as well."""
    positions = ((one, program.time_position(one.name, len(one.arguments))) for one in reach.known)
    times = (one.arguments[position] for one, position in positions if position is not None)
    if program.windows != [1] or any(one.type is _NUMBER and one.number > last + 1 for one in times):
        return False
    back = _longest_look_back(program)
    states = None if back is None else _states(program, reach, back)
    try:
        return states is not None and not _has_counterexample(program, sorted(rules), states)
    except RuntimeError:
        return False


def _has_counterexample(program: RelaxedProgram, rules: List[int], states: str) -> bool:
    """Return whether, from some state, the rules on the last step are violated at a step and not at the next."""
    ends = [one for one in rules if program.rules[one].kind is RuleKind.VOLATILE]
    kept = [clingo.Function(WHOLE, [clingo.Number(one)]) for one in rules if one not in ends]
    control = clingo.Control(["-Wnone", "1"], logger=lambda code, text: None)
    program.load_into(control)
    control.add("base", [], states + "".join(f"__oclingo_end({one}).\n" for one in ends))
    control.add("__oclingo_induction", [], _INDUCTION.format(broken=BROKEN, step=_STEP))
    steps = [clingo.Number(_STEP), clingo.Number(_STEP + 1)]
    control.ground([("base", [])])
    for step in steps:
        control.ground([("cumulative", [step]), ("volatile", [step])])
        control.assign_external(program.guard(1, step.number), True)
    control.ground([("__oclingo_induction", [])])
    return bool(control.solve(assumptions=[(one, True) for one in kept]).satisfiable)


def _states(program: RelaxedProgram, reach: Reach, back: int) -> Optional[str]:
    """Return choices for the reachable atoms of the ``back`` previous steps; None if they are uncertain."""
    found: Set[clingo.Symbol] = set()
    for signature in program.step_signatures | program.external_signatures:
        position = program.time_position(signature.name, signature.arity)
        for atom in reach.atoms(signature) if not signature.name.startswith(OWN) else ():
            found |= {_at(atom, position, _STEP - 1 - number) for number in range(1 if position is None else back)}
    return None if any(map(names_of, found)) else "\n".join(f"{{ {one} }}." for one in sorted(found)) + "\n"


def _at(atom: clingo.Symbol, position: Optional[int], time: int) -> clingo.Symbol:
    """Return an atom with another time."""
    arguments = [clingo.Number(time) if n == position else one for n, one in enumerate(atom.arguments)]
    return clingo.Function(atom.name, arguments, atom.positive)


def _longest_look_back(program: RelaxedProgram) -> Optional[int]:
    """Return the number of previous steps that rules refer to; None if they use the step in another way."""
    most = 1
    for part in program.parts:
        for statement, atoms in part.found if part.parameter else ():
            if statement.ast_type in (ASTType.Rule, ASTType.External):
                offsets = [_offset(program, one) for one in atoms]
                known = sum(mentions(one.term, part.parameter) for one in atoms)
                if None in offsets or known != mentions(statement, part.parameter):
                    return None
                most = max([most, *(-offset for offset in offsets if offset is not None)])
    return most


def _offset(program: RelaxedProgram, atom: Occurrence) -> Optional[int]:
    """Return the time of an atom relative to the step, 0 if it has none; None if unknown, or for a later head."""
    signature, arguments = atom.signature, atom.arguments
    position = program.time_position(signature.name, signature.arity)
    if signature.name.startswith(OWN):
        return 0
    if position is None:
        return 0 if not mentions(atom.term, atom.parameter) else None
    if sum(mentions(one, atom.parameter) for one in arguments) != mentions(arguments[position], atom.parameter):
        return None
    offset = atom.offsets.get(position)
    return None if offset is not None and offset > 0 and atom.head else offset
