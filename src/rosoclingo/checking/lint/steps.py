"""Heads without their step, which two steps may define, and looks back that keep all steps for ever."""

import re
from typing import Dict, Iterator, List, Optional, Set, Tuple

from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.checks import KEYWORDS
from rosoclingo.oclingo.program.look_back import longest_look_back, shortest_look_back, time_offset
from rosoclingo.oclingo.program.signatures import parted
from rosoclingo.oclingo.program.survey import Place, Survey, written
from rosoclingo.oclingo.program.times import time_positions
from rosoclingo.oclingo.progression.terms import Signature


def stepless(survey: Survey) -> List[Fault]:
    """Return the heads of steps that two steps may define, by what they write in place of the step."""
    found = []
    for signature, places in survey.defining.items():
        offsets: Dict[int, Set[int]] = {}
        for place in places:
            if place.part.parameter and not _is_fact(place) and not _happens_once(place, survey):
                told = _offsets(place, survey)
                if told:
                    for position, offset in told.items():
                        offsets.setdefault(position, set()).add(offset)
                elif not _pinned(place, survey):
                    found.append(_without_step(place))
        found += _differing(signature, places, offsets)
    return found


def _without_step(place: Place) -> Fault:
    term, step = place.occurrence.term, place.part.parameter
    message = (
        f"the head {written(term)} has no step: once the rules of two steps define it, clingo gives up (redefinition)"
    )
    arguments = parted(term)[1]
    example = "{}({})".format(place.signature.name, ",".join([*map(written, arguments), step]))
    return place.fault("no-step", message, f"give it the step, like {example}, or move the rule to base")


def _offsets(place: Place, survey: Survey) -> Dict[int, int]:
    """Return the positions of arguments that are the step plus a number, each with this number."""
    arguments = place.occurrence.arguments
    found = {n: time_offset(one, place.part.parameter, survey.constants) for n, one in enumerate(arguments)}
    return {position: offset for position, offset in found.items() if offset is not None}


def _pinned(place: Place, survey: Survey) -> bool:
    """Tell whether an argument of the head is a term that steps tell apart, or a variable that is bound to the step."""
    step, arguments = place.part.parameter, place.occurrence.arguments
    bounds = (place.statement, step, survey.constants)
    longest, shortest = longest_look_back(*bounds), shortest_look_back(*bounds)
    for one in arguments:
        name = one.name if one.ast_type == ASTType.Variable else ""
        if name and name in longest and longest[name] == shortest.get(name):
            return True
        if _mentions_step(str(one), step):
            return True
    return False


def _mentions_step(text: str, step: str) -> bool:
    return re.search(rf"(?<![\w']){re.escape(step)}(?![\w'])", text) is not None


def _is_fact(place: Place) -> bool:
    """Tell whether the head holds without condition: clingo does not mind if it does so again."""
    return place.statement.head.ast_type == ASTType.Literal and not place.statement.body


def _happens_once(place: Place, survey: Survey) -> bool:
    """Tell whether the body compares the step itself with something that does not change with it."""
    step = place.part.parameter
    for literal in getattr(place.statement, "body", ()):
        if literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.Comparison:
            sides = [literal.atom.term, *(guard.term for guard in literal.atom.guards)]
            if any(time_offset(side, step, survey.constants) is not None for side in sides):
                return True
    return False


def _differing(signature: Signature, places: List[Place], offsets: Dict[int, Set[int]]) -> Iterator[Fault]:
    """Yield a fault where heads of one predicate have their step at several offsets and in one place only."""
    if len(offsets) == 1 and len(next(iter(offsets.values()))) > 1:
        position, different = next(iter(offsets.items()))
        told = [one for one in places if one.part.parameter]
        if any(_may_be_same(one, other, position) for one in told for other in told if one is not other):
            words = " and ".join(_shift(told[0].part.parameter, one) for one in sorted(different))
            message = f"heads of {signature} are of the steps {words}: the rules of two steps may define the same atom"
            mend = "let all heads of a predicate have the same step, or use two predicates"
            yield told[-1].fault("no-step", message, mend)


def _shift(step: str, offset: int) -> str:
    return step if not offset else f"{step}{offset:+d}"


def _may_be_same(one: Place, other: Place, position: int) -> bool:
    """Tell whether two heads, the step aside, may be the same atom: constants of theirs do not differ."""
    pairs = list(zip(one.occurrence.arguments, other.occurrence.arguments))
    if str(pairs[position][0]) == str(pairs[position][1]):
        return False
    return all(_may_equal(*map(str, pair)) for number, pair in enumerate(pairs) if number != position)


def _may_equal(one: str, other: str) -> bool:
    fixed = [text for text in (one, other) if text[:1].islower() or text[:1] in '"-0123456789']
    plain = [text for text in fixed if not any(mark in text for mark in "(+*/")]
    return len(plain) < 2 or one == other


# ---- looks back -----------------------------------------------------------------------------------------------------


def histories(survey: Survey) -> List[Fault]:
    """Return the atoms by which the rules of a step look at all steps before: nothing of these is ever let go of."""
    positions = time_positions(survey.parts, survey.constants)
    found: Dict[Tuple[str, int, int], Fault] = {}
    for signature, places in survey.using.items():
        position = _time_of(signature, positions, survey)
        for place in places:
            fault = _endless(place, _compared_time(place, survey) if position is None else position, survey)
            if fault is not None:
                found.setdefault((fault.file, fault.line, fault.column), fault)
    return list(found.values())


def _time_of(signature: Signature, positions: Dict[Signature, int], survey: Survey) -> Optional[int]:
    """Return which argument of a predicate of steps is its time; None where that is not certain."""
    if KEYWORDS.get(signature.name) == signature:
        return signature.arity - 1
    told = [*survey.defining.get(signature, ()), *survey.declaring.get(signature, ())]
    return positions.get(signature) if any(one.part.parameter for one in told) else None


def _compared_time(place: Place, survey: Survey) -> Optional[int]:
    """Return the last argument of an open external where the rule compares it with the step: it is a time then."""
    arguments, step = place.occurrence.arguments, place.part.parameter
    if place.signature not in survey.opened or not arguments or not step:
        return None
    last = str(arguments[-1])
    comparisons = [
        str(one.atom)
        for one in getattr(place.statement, "body", ())
        if one.ast_type == ASTType.Literal and one.atom.ast_type == ASTType.Comparison
    ]
    compared = any(_mentions_step(text, step) and _mentions_step(text, last) for text in comparisons)
    return len(arguments) - 1 if compared else None


def _endless(place: Place, position: Optional[int], survey: Survey) -> Optional[Fault]:
    arguments = place.occurrence.arguments
    if position is None or position >= len(arguments) or arguments[position].ast_type != ASTType.Variable:
        return None
    step, name = place.part.parameter, arguments[position].name
    atom = written(place.occurrence.term)
    if not step:
        if place.signature not in survey.opened:
            return None
        message = f"a rule of base looks at {atom} of all cycles: none is ever over, a long run grows without end"
        return place.fault("history", message, "move the rule to cumulative(t), and write the step for the cycle")
    if name in longest_look_back(place.statement, step, survey.constants):
        return None
    shown = written(arguments[position])
    message = f"{atom} looks back at all steps: none is ever over, a long run grows without end"
    bound = f"{step}-T < 60" if shown == "_" else f"{step}-{shown} < 60"
    return place.fault("history", message, f"bound it, like {bound}, or hand on what is needed from step to step")
