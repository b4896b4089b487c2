"""Warnings about predicates that no rule and no external defines."""

from typing import Collection, List, Set

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.checks import KEYWORDS
from rosoclingo.oclingo.program.likeness import did_you_mean, most_similar
from rosoclingo.oclingo.program.nodes import fault_at
from rosoclingo.oclingo.program.survey import Survey
from rosoclingo.oclingo.progression.terms import Signature

QUERY = Signature("query", 1)
"""The external that clingo's incmode sets at the last step of a plan."""

_PRIME = "'"


def undefined_predicates(survey: Survey) -> List[Fault]:
    """Return one warning for each predicate that the program uses although nothing can make it true."""
    found: List[Fault] = []
    defined = survey.known
    for signature in dict.fromkeys([*survey.using, *survey.shown]):
        if signature in defined | survey.silenced:
            continue
        node = survey.using[signature][0].term if signature in survey.using else survey.shown[signature]
        message = f"no rule and no #external defines {signature}: it is never true"
        found.append(fault_at(node, "undefined", message, _remedy(signature, defined)))
    return found


def _remedy(signature: Signature, known: Set[Signature]) -> str:
    if signature == QUERY:
        return "in clingo's incmode it is true at a plan's last step; omit it in volatile(t), which holds only there"
    primed = primed_remedy(signature, known)
    if primed:
        return primed
    near = most_similar(signature, known | {*KEYWORDS.values()} if signature.name.startswith("_") else known)
    if near is not None:
        return f"{did_you_mean(near)} otherwise write #defined {signature}."
    return f"write a rule or an #external for it, or #defined {signature}."


def primed_remedy(signature: Signature, known: Collection[Signature]) -> str:
    """Return a fix for a primed predicate of telingo, which refers to another step; "" for any other predicate."""
    name = signature.name
    plain = name.strip(_PRIME)
    if plain == name or all(one.name != plain for one in known):
        return ""
    before = len(name) - len(name.lstrip(_PRIME))
    step = f"t-{before}" if before else "t"
    where = f"{before} step{'s' * (before > 1)} before" if before else "at the next step"
    remedy = f"{plain}(...,{step})" if before else f"{plain}(...,t) for the head, t-1 for the body"
    return f"in telingo {name} is {plain} {where}; write {remedy}"
