"""Predicates that nothing looks at, atoms that cannot be true, names that look misspelt."""

from typing import Dict, Iterable, Iterator, List, Optional, Set

import clingo
from clingo.ast import ASTType, ComparisonOperator, Sign

from rosoclingo.checking.lint.argument_values import ArgumentValues
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.checks import KEYWORDS
from rosoclingo.oclingo.program.likeness import asked, likely_value, slip_of
from rosoclingo.oclingo.program.literals import names_in
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import occurrences, signature_and_arguments
from rosoclingo.oclingo.program.survey import LABELS, Place, Survey, fault_at, written
from rosoclingo.oclingo.program.undefined import primed_mend
from rosoclingo.oclingo.progression.terms import Signature
from rosoclingo.planning.explaining.atom_patterns import shown

MANY = 6  # values that a message lists

_KEYWORDS = frozenset(KEYWORDS.values())

_INCOMING = frozenset({"_request", "_return", "_failed", "_cancel"})

_OUTGOING = {one for one in _KEYWORDS if one.name not in _INCOMING} | {Signature("_draws", 2), Signature("_draws", 3)}
"""The predicates that others read from an answer, even if it does not show them."""


# ---- nothing looks at it --------------------------------------------------------------------------------------------


def unused(survey: Survey) -> List[Fault]:
    """Return the predicates that nothing looks at: those that look misspelt, others where not all is shown anyway."""
    found: List[Fault] = []
    looked_at = {one for one in survey.using if _is_used(survey, one)} | survey.shown.keys() | _OUTGOING
    for signature in [*survey.opened, *survey.declaring, *survey.defining]:
        if signature in looked_at:
            continue
        meant = None if signature in _KEYWORDS else slip_of(signature, looked_at | _KEYWORDS, survey.shows)
        places = survey.defining.get(signature, survey.declaring.get(signature))
        primed = primed_mend(signature, survey.known)
        if primed or meant is not None:
            found += _at(survey, signature, places, "misspelt", primed or asked(meant))
        elif survey.shows:
            use = "write a rule for it" if signature.name in _INCOMING else f"use it, #show {signature}."
            found += _at(survey, signature, places, "unused", f"{use} or leave it out")
    return found


def _is_used(survey: Survey, signature: Signature) -> bool:
    """Tell whether the predicate is looked at elsewhere than where it defines itself."""
    return any(not _defines_alone(one.statement, signature) for one in survey.using[signature])


def _defines_alone(statement: Node, signature: Signature) -> bool:
    heads = {one.signature for one in occurrences(statement) if one.head}
    return statement.ast_type == ASTType.Rule and heads == {signature}


def _at(survey: Survey, signature: Signature, places: Optional[List[Place]], kind: str, mend: str) -> Iterator[Fault]:
    if places is None:
        opened = survey.opened[signature]
        yield Fault(opened.file, opened.line, 1, f"nothing looks at the external {signature}", mend, kind)
    elif places[0].occurrence.term.location.begin.filename != LABELS:
        what = "the external " if places[0].declares else ""
        shown = "" if places[0].declares or not survey.shows else ", and nothing shows it"
        yield places[0].fault(kind, f"nothing looks at {what}{signature}{shown}", mend)


# ---- what can never be true -----------------------------------------------------------------------------------------


def never_matching(survey: Survey, values: ArgumentValues) -> List[Fault]:
    """Return the atoms in bodies with an argument that nothing gives their predicate."""
    found = []
    for signature, used in survey.using.items():
        if signature in survey.known and values.is_possible(signature):
            found += [fault for place in used for fault in _mismatch(place, values)]
    return found


def _mismatch(place: Place, values: ArgumentValues) -> Iterator[Fault]:
    term = place.occurrence.term
    misfit = values.misfitting(term, place.part.parameter)
    if misfit is not None:
        position, may_be = misfit
        argument = signature_and_arguments(term)[1][position]
        known = sorted(shown(one) for one in may_be)
        message = f"{place.signature} is never true with {written(argument)} as argument {position + 1}"
        yield fault_at(argument, "no-match", message, likely_value(str(argument), known))


def disjoint(values: ArgumentValues) -> Iterator[Fault]:
    """Yield the rules of which two atoms share a variable, but no value of it."""
    for number, rule in enumerate(values.rules):
        found = values.disjoint(number)
        if found is not None and not rule.head.term.location.begin.filename.startswith("<"):
            name, atom, other = found.variable, written(found.atom.term), written(found.other.term)
            message = f"the rule never applies: no {name} fits both {other} and {atom}"
            mend = f"it is {_listed(found.others)} in the one, {_listed(found.its)} in the other"
            yield fault_at(found.atom.term, "no-match", message, mend)


def _listed(values: Iterable[clingo.Symbol]) -> str:
    known = sorted(shown(one) for one in values)
    return ", ".join(known[:MANY]) + " ..." * (len(known) > MANY)


def unfounded(survey: Survey, values: ArgumentValues) -> List[Fault]:
    """Return the predicates with rules that need one another in a circle, so that none is ever true."""
    needs: Dict[Signature, Set[Signature]] = {}
    excused: Set[Signature] = set()
    for rule in values.rules:
        signature = rule.head.signature
        if not values.is_possible(signature):
            missing = {one.signature for one in rule.body if not values.is_possible(one.signature)}
            needs.setdefault(signature, set()).update(missing)
            excused.update(() if missing else {signature})
    before = -1
    while before < len(excused):
        before = len(excused)
        excused |= {one for one, missing in needs.items() if missing & excused}
    found = []
    for signature in needs.keys() - excused:
        names = ", ".join(map(str, sorted(needs[signature])))
        message = f"{signature} is never true: its rules need {names}, and no fact or choice is at the bottom of these"
        places = [*survey.defining.get(signature, ()), *survey.declaring.get(signature, ())]
        found.append(places[0].fault("unfounded", message, "write the rule by which it begins"))
    return found


# ---- rules that cannot hold, or derive nothing ----------------------------------------------------------------------


def odd_rules(survey: Survey) -> Iterator[Fault]:
    """Yield what is odd in a rule by itself: contradictions, its own head in its body, two variables that are one."""
    for _, statement, _ in survey.statements:
        body = [one for one in getattr(statement, "body", ()) if isinstance(one, Node)]
        literals = [one for one in body if one.ast_type == ASTType.Literal]
        plain = {str(one.atom): one for one in literals if _is_plain(one)}
        for one in literals:
            atom = written(one.atom)
            if one.sign == Sign.Negation and one.atom.ast_type == ASTType.SymbolicAtom and str(one.atom) in plain:
                message = f"{atom} and not {atom} stand in one body: it never holds"
                yield fault_at(one, "contradiction", message, "leave one of them out")
            elif one.sign == Sign.NoSign and one.atom.ast_type == ASTType.Comparison and len(one.atom.guards) == 1:
                yield from _odd_comparison(one, plain.values())
        if statement.ast_type == ASTType.Rule and _is_plain(statement.head) and str(statement.head.atom) in plain:
            message = f"the rule needs its own head {written(statement.head.atom)}: it gives nothing"
            yield fault_at(statement.head, "tautology", message, "is another step meant in the body?")


def _is_plain(literal: Node) -> bool:
    kinds = literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.SymbolicAtom
    return bool(kinds and literal.sign == Sign.NoSign)


def _odd_comparison(literal: Node, atoms: Iterable[Node]) -> Iterator[Fault]:
    """Yield a comparison of a term with itself, and an equation of two variables that atoms bind."""
    left, guard = literal.atom.term, literal.atom.guards[0]
    if guard.comparison in _STRICT and str(left) == str(guard.term) != "_":
        yield fault_at(
            literal, "contradiction", f"{written(literal.atom)} never holds", "compare it with something else"
        )
    names = [one.name for one in (left, guard.term) if one.ast_type == ASTType.Variable]
    equation = guard.comparison == ComparisonOperator.Equal and len(names) == 2
    # in conditions of control programs there is no other way to say it of a parameter
    meant = not equation or literal.location.begin.filename.endswith(".golog")
    if not meant and set(names) <= {name for one in atoms for name in names_in(one)}:
        message = f"{names[0]} = {names[1]} says of two variables of atoms that they are one"
        mend = f"write {names[0]} in the place of {names[1]}, or {names[0]} != {names[1]}"
        yield fault_at(literal, "same-variables", message, mend)


_STRICT = (ComparisonOperator.NotEqual, ComparisonOperator.LessThan, ComparisonOperator.GreaterThan)
