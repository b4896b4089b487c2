"""Predicates that nothing defines."""

from typing import List, Set

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.checks import KEYWORDS
from rosoclingo.oclingo.program.lint.likeness import asked, likely
from rosoclingo.oclingo.program.lint.other_systems import primed_mend, query_mend
from rosoclingo.oclingo.program.lint.survey import Survey, fault_at
from rosoclingo.oclingo.progression.terms import Signature


def undefined(survey: Survey) -> List[Fault]:
    """Return, once for each, the predicates that the program mentions though nothing can make them true."""
    found: List[Fault] = []
    defined = survey.known
    for signature in dict.fromkeys([*survey.using, *survey.shown]):
        if signature in defined | survey.silenced:
            continue
        node = survey.using[signature][0].occurrence.term if signature in survey.using else survey.shown[signature]
        message = f"no rule and no #external defines {signature}: it is never true"
        found.append(fault_at(node, "undefined", message, _mend(signature, defined)))
    return found


def _mend(signature: Signature, known: Set[Signature]) -> str:
    other = primed_mend(signature, known) or query_mend(signature)
    if other:
        return other
    near = likely(signature, known | {*KEYWORDS.values()} if signature.name.startswith("_") else known)
    if near is not None:
        return f"{asked(near)} else write #defined {signature}."
    return f"write a rule or an #external for it, or #defined {signature}."
