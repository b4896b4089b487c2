"""Checks for faults of a program that clingo does not report.

Without these checks such a fault would show in the middle of a run, or as a plan that is never found. If the program
uses rosoclingo's keywords, most findings are errors. In other programs, written for oClingo, they are warnings.
"""

from typing import List, Sequence, Tuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.parts import Occurrence, Part
from rosoclingo.oclingo.program.survey import Survey, term_text
from rosoclingo.oclingo.progression.terms import Signature

_FORMS = {
    "_action_lib": "(Action,Parameter,C)",
    "_return": "(Action,Value,C)",
    "_failed": "(Action,Value,C)",
    "_request": "(Goal,C)",
    "_status": "(Id,Status,C)",
    "_explain": "(What,Text,C)",
    "_cancel": "(Action,Parameter,C)",
    "_running": "(Action,Parameter,C)",
    "_refuse": "(Fact,Text,C)",
    "_never": "(Text,C)",
    "_says": "(Action,Text)",
    "_steps": "(Number,C)",
}
KEYWORDS = {name: Signature(name, form.count(",") + 1) for name, form in _FORMS.items()}
"""The predicates through which a program communicates with rosoclingo's core."""


def uses_keywords(parts: Sequence[Part]) -> bool:
    """Return whether a program is written for rosoclingo's core."""
    return any(one.signature.name in KEYWORDS for part in parts for one in part.atoms)


def wrong_arities(parts: Sequence[Part]) -> List[Fault]:
    """Return a fault for each keyword with a wrong number of arguments."""
    found = []
    for one in (one for part in parts for one in part.atoms):
        signature = one.signature
        keyword = KEYWORDS.get(signature.name, signature)
        if signature.arity != keyword.arity:
            message = f"keyword {signature.name} with {signature.arity} arguments"
            remedy = f"write {signature.name}{_FORMS[signature.name]}"
            found.append(one.fault("keyword-arity", message, remedy))
    return found


def missing_parts(parts: Sequence[Part]) -> List[Fault]:
    """Return a fault if the program has no cumulative part, and one if it has no volatile part."""
    present = {part.name for part in parts}
    first = parts[0].header.location.begin.filename
    remedies = {
        "cumulative": "write #program cumulative(t). before the rules for each step t",
        "volatile": "write #program volatile(t). before the constraints on a plan that ends at step t",
    }
    missing = [name for name in remedies if name not in present]
    return [Fault(first, 0, 0, f"the program has no {name} part", remedies[name], "missing-part") for name in missing]


def late_externals(survey: Survey) -> List[Fault]:
    """Return a fault for each rule that uses an external before the step that declares it."""
    found = []
    for signature, declared in survey.declaring.items():
        if signature not in survey.opened and signature not in survey.defining:
            uses = survey.using.get(signature, ())
            late = (use for use in uses if all(_too_late(use, one) for one in declared))
            found += [use.fault("late-external", *_late(use, declared[0])) for use in late]
    return found


def _late(use: Occurrence, declaration: Occurrence) -> Tuple[str, str]:
    term, known = term_text(use.term), term_text(declaration.term)
    if not use.parameter:
        return (
            f"external {term} is used in base but declared in steps, so the rule never sees it",
            f"move the rule to the {declaration.part.name} part, or the #external to base",
        )
    return (
        f"external {term} is declared too late: at the step of the rule only {known} is declared",
        f"write #external {term}.",
    )


def _too_late(use: Occurrence, declaration: Occurrence) -> bool:
    """Return whether the declaration comes at a later step than the use."""
    if not declaration.parameter:
        return False
    if not use.parameter:
        return True
    ahead, known = use.offsets, declaration.offsets
    position = min(ahead.keys() & known.keys(), default=None)
    return position is not None and ahead[position] > known[position]
