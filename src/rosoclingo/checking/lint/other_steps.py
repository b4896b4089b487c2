"""Steps that do not belong together: those of an action and its return or its rule, of an end and what is asked."""

from typing import Dict, Iterator, List, Optional, Sequence

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.action_rules import ACTION, RETURN
from rosoclingo.oclingo.program.directive_values import number_of
from rosoclingo.oclingo.program.directives import Placed
from rosoclingo.oclingo.program.look_back import shortest_look_back, time_offset
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.signatures import Occurrence, evaluate
from rosoclingo.oclingo.program.survey import OWN, Place, Survey, fault_at, written

_KIND, _PAST = "other-step", "past-volatile"


def other_steps(survey: Survey) -> Iterator[Fault]:
    """Yield the actions whose step is another than that of their return, or than that of the rule that plans them."""
    for part, statement, found in survey.statements:
        if part.parameter and statement.ast_type == ASTType.Rule:
            acts = [one for one in found if one.signature == ACTION]
            returns = [one for one in found if one.signature == RETURN and not one.head]
            yield from (_planned(part, one, survey) for one in acts if one.head and _step(part, one, survey))
            for act in acts:
                yield from _apart(part, act, returns, survey)


def _step(part: Part, atom: Occurrence, survey: Survey) -> Optional[int]:
    """Return how far an atom of a keyword is from the step, None where that is open."""
    return time_offset(atom.arguments[-1], part.parameter, survey.constants)


def _planned(part: Part, act: Occurrence, survey: Survey) -> Fault:
    message = f"{written(act.term)} is an action of another step than {part.parameter}, at which it is planned"
    return fault_at(act.term, _KIND, message, f"write {part.parameter} for its cycle")


def _apart(part: Part, act: Occurrence, returns: Sequence[Occurrence], survey: Survey) -> Iterator[Fault]:
    """Yield a return of an action of the same rule that has another cycle."""
    mine, name = _step(part, act, survey), str(act.arguments[0])
    same = [one for one in returns if str(one.arguments[0]) == name]
    steps = [_step(part, one, survey) for one in same]
    if mine is not None and None not in steps and same and mine not in steps:
        message = f"{written(same[0].term)} is no return of {written(act.term)}, which has another cycle"
        yield fault_at(same[0].term, _KIND, message, "an action and its return have the same cycle")


def early_ends(survey: Survey) -> Iterator[Fault]:
    """Yield the constraints on a plan's end of which no atom is of its last step, though all have a step."""
    for part, statement, found in survey.statements:
        if part.name == "volatile" and statement.ast_type == ASTType.Rule and _is_constraint(statement):
            steps = [_steps(part, one, survey) for one in found if not one.signature.name.startswith(OWN)]
            if steps and all(one and max(one) < 0 for one in steps):
                message = f"nothing of this is of step {part.parameter}: a plan's last step is not asked for"
                yield fault_at(statement, _KIND, message, f"write {part.parameter} for the step")


def _is_constraint(statement: Node) -> bool:
    return statement.head.ast_type == ASTType.Literal and statement.head.atom.ast_type == ASTType.BooleanConstant


def _steps(part: Part, atom: Occurrence, survey: Survey) -> List[int]:
    found = [time_offset(one, part.parameter, survey.constants) for one in atom.arguments]
    return [one for one in found if one is not None]


# ---- the volatile part ----------------------------------------------------------------------------------------------


def gone(survey: Survey, first: int) -> Iterator[Fault]:
    """Yield the looks back at atoms that only the volatile part defines, and that are gone by then.

    ``first`` is the first step.
    """
    for signature, heads in survey.defining.items():
        begins = [one for one in heads if not one.part.parameter]
        windows = [_window(one, survey) for one in heads if one.part.parameter]
        if survey.is_external(signature) or not windows or None in windows:
            continue
        offsets = [_offsets(one, survey) for one in heads if one.part.parameter]
        for position in set.intersection(*map(set, offsets)):
            last = min(one[position] - window for one, window in zip(offsets, windows) if window is not None)
            if all(_is_before(one, position, first, survey) for one in begins):
                uses = survey.using.get(signature, ())
                yield from (_gone(one, survey) for one in uses if _looks_behind(one, position, last, survey))


def _gone(place: Place, survey: Survey) -> Fault:
    message = f"{written(place.occurrence.term)} looks back at the volatile part, whose atoms of earlier steps are gone"
    return place.fault(
        _PAST, message, f"move the rules of {place.signature} to #program cumulative({place.part.parameter})."
    )


def _window(place: Place, survey: Survey) -> Optional[int]:
    """Return the number of steps for which the head of a rule holds; None if it stays."""
    term = Placed(place.part.window, "", "", 0)
    return number_of(term, survey.constants, []) if place.part.window else None


def _offsets(place: Place, survey: Survey) -> Dict[int, int]:
    found = [time_offset(one, place.part.parameter, survey.constants) for one in place.occurrence.arguments]
    return {position: offset for position, offset in enumerate(found) if offset is not None}


def _is_before(place: Place, position: int, first: int, survey: Survey) -> bool:
    """Tell whether a head of base is of a step before the first one."""
    value = evaluate(place.occurrence.arguments[position], survey.constants)
    return value is not None and value.type is clingo.SymbolType.Number and value.number < first


def _looks_behind(place: Place, position: int, last: int, survey: Survey) -> bool:
    """Tell whether an atom is of steps whose atoms are gone, as the window of its last rule ends before."""
    step, argument = place.part.parameter, place.occurrence.arguments[position]
    if not step or place.statement.ast_type == ASTType.External:
        return False
    offset = time_offset(argument, step, survey.constants)
    if offset is None and argument.ast_type == ASTType.Variable:
        nearest = shortest_look_back(place.statement, step, survey.constants).get(argument.name)
        offset = None if nearest is None else -nearest
    return offset is not None and offset <= last
