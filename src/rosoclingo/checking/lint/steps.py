"""Checks of steps: heads that two steps define, references to other steps, actions with another cycle."""

from typing import Dict, Iterator, List, Optional, Sequence, Tuple

from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.action_rules import ACTION, RETURN
from rosoclingo.oclingo.program.checks import KEYWORDS
from rosoclingo.oclingo.program.literals import mentions
from rosoclingo.oclingo.program.look_back import longest_look_back
from rosoclingo.oclingo.program.nodes import Node, fault_at
from rosoclingo.oclingo.program.parts import Occurrence
from rosoclingo.oclingo.program.survey import OWN, Survey, term_text
from rosoclingo.oclingo.program.times import time_positions
from rosoclingo.oclingo.progression.terms import Signature

_Atoms = Sequence[Occurrence]

_ALIKE = 4  # least number of atoms from which the position of the step is inferred


def wrong_steps(survey: Survey, first: int) -> List[Fault]:
    """Return the faults of predicates other than keywords; ``first`` is the first step."""
    found: List[Fault] = []
    for signature, defining in survey.defining.items():
        uses = survey.using.get(signature, [])
        timed = [one for one in defining if one.parameter]
        found += [*_heads_without_step(timed), *_mixed_offsets(signature, timed)]
        found += _misplaced_steps([*defining, *uses])
        found += _first_steps(defining, timed, survey, first)
        if not survey.is_external(signature):
            found += [*_looks_ahead(defining, timed, uses), *_volatile_look_backs(defining, uses)]
    return found


# ---- heads ----------------------------------------------------------------------------------------------------------


def _heads_without_step(timed: _Atoms) -> Iterator[Fault]:
    """Yield the heads that a rule derives at each step; facts do not count, as clingo accepts them twice."""
    for place in timed:
        is_fact = place.statement.head.ast_type == ASTType.Literal and not place.statement.body
        head, step = term_text(place.term), place.parameter
        if not (place.offsets or is_fact or mentions(place.term, step) or _comparisons_with_step(place)):
            message = f"the head {head} has no step: clingo stops (redefinition) when the rules of two steps define it"
            example = "{}({})".format(place.signature.name, ",".join([*map(term_text, place.arguments), step]))
            yield place.fault("no-step", message, f"add the step, as in {example}, or move the rule to base")


def _comparisons_with_step(place: Occurrence) -> List[Node]:
    """Return the comparisons of a rule that mention its step."""
    comparisons = (one for one in place.statement.nodes if one.ast_type == ASTType.Comparison)
    return [one for one in comparisons if mentions(one, place.parameter)]


def _mixed_offsets(signature: Signature, timed: _Atoms) -> Iterator[Fault]:
    """Yield a head of a predicate whose heads have different offsets of the step in the same argument."""
    steps = {step for one in timed for step in one.offsets.items()}
    offsets = sorted({offset for _, offset in steps})
    if len(offsets) > 1 and len({position for position, _ in steps}) == 1:
        words = " and ".join(timed[0].parameter + (f"{one:+d}" if one else "") for one in offsets)
        message = f"heads of {signature} have the steps {words}: rules of two steps can define the same atom"
        remedy = "use the same step in all heads of a predicate, or two predicates"
        yield timed[-1].fault("no-step", message, remedy)


def _misplaced_steps(atoms: _Atoms) -> Iterator[Fault]:
    """Yield the atom whose step is another argument than in all other atoms of its predicate."""
    positioned = [(one, set(one.offsets)) for one in atoms if one.offsets]
    if len(positioned) < _ALIKE or any(one.parameter and not one.offsets for one in atoms):
        return
    for place, positions in positioned:
        others = set.intersection(*(other for one, other in positioned if one is not place))
        if others and not others & positions:
            number = min(others) + 1
            message = f"{term_text(place.term)} misplaces its step: in all other atoms it is argument {number}"
            yield place.fault("exchanged", message, f"write the step as argument {number}")


def _first_steps(heads: _Atoms, timed: _Atoms, survey: Survey, first: int) -> Iterator[Fault]:
    """Yield the facts about a step whose own rules define the predicate."""
    for position in set.intersection(*(set(one.offsets) for one in timed)) if timed else ():
        own = [first + one.offsets[position] for one in timed if not _comparisons_with_step(one)]
        for place in heads:
            step = None if place.parameter else survey.number(place.arguments[position])
            if step is not None and own and step >= min(own):
                text, before = term_text(place.term), first - 1
                message = (
                    f"{text} is a fact of step {step}, whose own rules define it: initial facts have step {before}"
                )
                yield place.fault("first-step", message, f"write {before} for the step")


# ---- references to other steps --------------------------------------------------------------------------------------


def _looks_ahead(heads: _Atoms, timed: _Atoms, uses: _Atoms) -> Iterator[Fault]:
    """Yield the atoms of a later step, whose rules are not grounded yet."""
    for place in uses:
        term, step = term_text(place.term), place.parameter
        if not step and len(timed) == len(heads):
            message = f"a rule of base uses {term}, but only rules of steps define it: it is never true"
            yield place.fault("look-ahead", message, "move the statement to #program cumulative(t).")
        elif timed and place.statement.ast_type == ASTType.Rule:
            for position, offset in place.offsets.items():
                if all(one.offsets.get(position, offset) < offset for one in timed):
                    message = f"the rules of a later step define {term}; they are not grounded yet at step {step}"
                    yield place.fault("look-ahead", message, "refer to the step itself or an earlier one")
                    break


def _volatile_look_backs(heads: _Atoms, uses: _Atoms) -> Iterator[Fault]:
    """Yield the references to earlier atoms of predicates that only the volatile part defines."""
    if any(one.part.window != "1" for one in heads):
        return
    for position in set.intersection(*(set(one.offsets) for one in heads)):
        least = min(one.offsets[position] for one in heads)
        for place in uses:
            if place.offsets.get(position, least) < least and place.statement.ast_type != ASTType.External:
                term = term_text(place.term)
                message = f"{term} looks back at the volatile part, whose atoms are removed after their step"
                remedy = f"move the rules of {place.signature} to #program cumulative({place.parameter})."
                yield place.fault("past-volatile", message, remedy)


def unbounded_look_backs(survey: Survey) -> List[Fault]:
    """Return the atoms by which rules refer to all earlier steps, so that no step can be compacted."""
    positions = time_positions(survey.parts)
    found: Dict[Tuple[str, int, int], Fault] = {}
    for signature, places in survey.using.items():
        heads = [*survey.defining.get(signature, ()), *survey.declaring.get(signature, ())]
        known = positions.get(signature) if any(one.parameter for one in heads) else None
        if KEYWORDS.get(signature.name) == signature:
            known = signature.arity - 1
        for place in places:
            position = _compared_time(place, survey) if known is None else known
            fault = None if position is None else _endless(place, position, survey)
            if fault is not None:
                found.setdefault((fault.file, fault.line, fault.column), fault)
    return list(found.values())


def _compared_time(place: Occurrence, survey: Survey) -> Optional[int]:
    """Return the last argument of an open external if the rule compares it with the step, and so uses it as a time."""
    arguments = place.arguments
    if place.signature not in survey.opened or not arguments or not place.parameter:
        return None
    terms = [str(node) for one in _comparisons_with_step(place) for node in one.nodes]
    return len(arguments) - 1 if str(arguments[-1]) in terms else None


def _endless(place: Occurrence, position: int, survey: Survey) -> Optional[Fault]:
    arguments, step = place.arguments, place.parameter
    if position >= len(arguments) or arguments[position].ast_type != ASTType.Variable:
        return None
    atom, shown = term_text(place.term), term_text(arguments[position])
    if step and arguments[position].name not in longest_look_back(place.statement, step, survey.constants):
        message = f"{atom} looks back at all steps: none can be compacted, and a long run grows without bound"
        bound = f"{step}-T < 60" if shown == "_" else f"{step}-{shown} < 60"
        return place.fault("history", message, f"bound it, like {bound}, or carry the state from step to step")
    if not step and place.signature in survey.opened:
        message = f"a rule of base uses {atom} of all cycles: none can be compacted, and a long run grows without bound"
        return place.fault("history", message, "move the rule to cumulative(t) and use the step as the cycle")
    return None


# ---- actions, returns and constraints on the last step --------------------------------------------------------------


def mismatched_steps(survey: Survey) -> Iterator[Fault]:
    """Yield actions with another step than their rule or return, and constraints that ignore the last step."""
    for part, statement, found in survey.statements:
        if not part.parameter or statement.ast_type != ASTType.Rule:
            continue
        places = [one for one in found if not one.signature.name.startswith(OWN)]
        returns = [one for one in places if one.signature == RETURN and not one.head]
        for act in (one for one in places if one.signature == ACTION):
            if act.head and act.offsets.get(2):
                message = f"{term_text(act.term)} has another cycle than {part.parameter}, its step"
                yield act.fault("other-step", message, f"write {part.parameter} for its cycle")
            yield from _mismatched_returns(act, returns, survey)
        head = statement.head
        is_constraint = head.ast_type == ASTType.Literal and head.atom.ast_type == ASTType.BooleanConstant
        ends = part.name == "volatile" and is_constraint
        steps = [one.offsets.values() for one in places] if ends else []
        if steps and all(one and max(one) < 0 for one in steps):
            message = f"no atom here has step {part.parameter}: the constraint ignores a plan's last step"
            yield fault_at(statement, "other-step", message, f"write {part.parameter} for the step")


def _mismatched_returns(act: Occurrence, returns: _Atoms, survey: Survey) -> Iterator[Fault]:
    """Yield a return whose cycle differs from that of its action in the same rule."""
    mine, name = act.offsets.get(2), str(act.arguments[0])
    same = [one for one in returns if str(one.arguments[0]) == name]
    steps = [one.offsets.get(2) for one in same]
    if mine is not None and same and None not in steps and mine not in steps:
        atoms = [term_text(one.term) for one in (same[0], act)]
        message = f"{atoms[0]} is not the return of {atoms[1]}, which has another cycle"
        yield same[0].fault("other-step", message, "an action and its return have the same cycle")
