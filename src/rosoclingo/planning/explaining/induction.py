"""Whether no longer plan does, either: by induction over the steps.

All plans of some length break rules on their end. That stays so where, of any two steps one after the other, from
whatever state at all, these rules are broken at the second wherever they are at the first. States are those of
:mod:`~rosoclingo.planning.explaining.reach`, and so too many: what is found is certain, but not all is found.
"""

from typing import Iterable, List, Optional

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.lint.rule_shapes import parted
from rosoclingo.oclingo.program.lint.survey import OWN
from rosoclingo.oclingo.program.look_back import time_offset
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.signatures import Occurrence
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.planning.explaining.named_rules import RuleKind
from rosoclingo.planning.explaining.reach import Reach
from rosoclingo.planning.explaining.relaxed_program import BROKEN, WHOLE, RelaxedProgram

_STEP = 1_000_000  # any step that is beyond all that was told

_INDUCTION = """
__oclingo_ends :- {broken}(N,{step},V), __oclingo_end(N).
:- not __oclingo_ends.
:- {broken}(N,{step}+1,V), __oclingo_end(N).
"""


def breaks_for_ever(program: RelaxedProgram, rules: Iterable[int], reach: Reach, last: int) -> bool:
    """Tell whether plans of more than ``last`` steps break the ``rules`` as well; False where that is not known."""
    told = (reach.time_of(one) for one in reach.known)
    if program.windows != [1] or any(time is not None and time > last + 1 for time in told):
        return False
    back = _longest_look_back(program)
    if back is None:
        return False
    try:
        return not _goes_on(program, sorted(rules), _states(program, reach, back))
    except RuntimeError:
        return False


def _goes_on(program: RelaxedProgram, rules: List[int], states: str) -> bool:
    """Tell whether, from some state, the rules on the end are broken at a step, and not at the next one."""
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


def _states(program: RelaxedProgram, reach: Reach, back: int) -> str:
    """Return what may be true at the steps before, free to choose."""
    steps = program.step_signatures | program.external_signatures
    found: List[str] = []
    for atom in sorted(reach.atoms):
        if reach.time_of(atom) is not None:
            found += [f"{{ {reach.at(atom, _STEP - 1 - number)} }}." for number in range(back)]
        elif signature_of(atom) in steps:
            found.append(f"{{ {atom} }}.")
    return "\n".join(found) + "\n"


def _longest_look_back(program: RelaxedProgram) -> Optional[int]:
    """Return over how many steps the rules of a step look back; None where they tell steps apart in another way."""
    most = 1
    for part in program.parts:
        for statement, atoms in part.found if part.parameter else ():
            if statement.ast_type in (ASTType.Rule, ASTType.External):
                offsets = [_offset(program, part, one) for one in atoms]
                known = sum(_mentions(one.term, part.parameter) for one in atoms)
                if None in offsets or known != _mentions(statement, part.parameter):
                    return None
                most = max([most, *(-offset for offset in offsets if offset is not None)])
    return most


def _offset(program: RelaxedProgram, part: Part, atom: Occurrence) -> Optional[int]:
    """Return how far an atom is from the step, 0 for one without a time; None where that is open, or yet to come."""
    signature, arguments = parted(atom.term)
    position = program.time_position(signature.name, signature.arity)
    if signature.name.startswith(OWN):
        return 0
    if position is None:
        return 0 if not _mentions(atom.term, part.parameter) else None
    if sum(_mentions(one, part.parameter) for one in arguments) != _mentions(arguments[position], part.parameter):
        return None
    offset = time_offset(arguments[position], part.parameter, dict(program.values))
    return None if offset is not None and offset > 0 and atom.head else offset


def _mentions(node: Node, step: str) -> int:
    """Return how often the step stands in a statement or a term."""
    return sum(one.ast_type == ASTType.SymbolicTerm and str(one) == step for one in node.nodes)
