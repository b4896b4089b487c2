"""Checks of predicates: unused ones, atoms that are never true, misspelt names, rules that derive nothing."""

from typing import Dict, Iterable, Iterator, List, Optional, Set

import clingo
from clingo.ast import ASTType, ComparisonOperator, Sign

from rosoclingo.checking.lint.argument_values import ArgumentValues
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.action_rules import RUNNING, TAKES
from rosoclingo.oclingo.program.checks import KEYWORDS
from rosoclingo.oclingo.program.likeness import did_you_mean, likely_spelling, likely_value
from rosoclingo.oclingo.program.literals import is_plain_atom, names_in
from rosoclingo.oclingo.program.nodes import Node, fault_at
from rosoclingo.oclingo.program.parts import Occurrence
from rosoclingo.oclingo.program.survey import LABELS, Survey, term_text
from rosoclingo.oclingo.program.undefined import primed_remedy
from rosoclingo.oclingo.progression.terms import Signature
from rosoclingo.planning.explaining.atom_patterns import format_pattern

MANY = 6  # values that a message lists

_KEYWORDS = frozenset(KEYWORDS.values())

_INCOMING = frozenset({"_request", "_return", "_failed", "_cancel", "_running"})

_OUTGOING = {one for one in _KEYWORDS if one.name not in _INCOMING} | {Signature("_draws", 2), Signature("_draws", 3)}
"""The predicates that are read from an answer even if the program does not show them."""


# ---- unused predicates ----------------------------------------------------------------------------------------------


def unused_predicates(survey: Survey) -> List[Fault]:
    """Return the unused predicates that look misspelt and, in programs with ``#show``, all others."""
    found: List[Fault] = []
    looked_at = (
        {one for one, places in survey.using.items() if any(not _defines_alone(place) for place in places)}
        | survey.shown.keys()
        | _OUTGOING
        | ({TAKES} if RUNNING in survey.opened else set())  # the planner compares plans by it
    )
    for signature in [*survey.opened, *survey.declaring, *survey.defining]:
        if signature in looked_at:
            continue
        meant = None if signature in _KEYWORDS else likely_spelling(signature, looked_at | _KEYWORDS, survey.shows)
        places = survey.defining.get(signature, survey.declaring.get(signature))
        primed = primed_remedy(signature, survey.known)
        if primed or meant is not None:
            found += _unused(survey, signature, places, "misspelt", primed or did_you_mean(meant))
        elif survey.shows:
            use = "write a rule for it" if signature.name in _INCOMING else f"use it, #show {signature}."
            found += _unused(survey, signature, places, "unused", f"{use} or remove it")
    return found


def _defines_alone(place: Occurrence) -> bool:
    """Return whether a rule uses a predicate only to define it recursively."""
    heads = {one.signature for one in place.part.atoms if one.head and one.statement is place.statement}
    return place.statement.ast_type == ASTType.Rule and heads == {place.signature}


def _unused(
    survey: Survey, signature: Signature, places: Optional[List[Occurrence]], kind: str, remedy: str
) -> Iterator[Fault]:
    if places is None:
        opened = survey.opened[signature]
        yield Fault(opened.file, opened.line, 1, f"no rule uses the external {signature}", remedy, kind)
    elif places[0].term.location.begin.filename != LABELS:
        what = "the external " if places[0].declares else ""
        shown = "" if places[0].declares or not survey.shows else ", and no #show shows it"
        yield places[0].fault(kind, f"no rule uses {what}{signature}{shown}", remedy)


# ---- atoms that are never true --------------------------------------------------------------------------------------


def mismatched_atoms(survey: Survey, values: ArgumentValues) -> Iterator[Fault]:
    """Yield the body atoms with an argument value that their predicate never has."""
    possible = (one for one in survey.using if one in survey.known and values.is_possible(one))
    for place in (one for signature in possible for one in survey.using[signature]):
        impossible = values.impossible_argument(place.term, place.part.parameter)
        if impossible is not None:
            position, known = impossible
            argument = place.arguments[position]
            message = f"{place.signature} is never true with {term_text(argument)} as argument {position + 1}"
            yield fault_at(
                argument, "no-match", message, likely_value(str(argument), sorted(map(format_pattern, known)))
            )


def disjoint_bodies(values: ArgumentValues) -> Iterator[Fault]:
    """Yield the rules in which two atoms share a variable without a common value."""
    for number, rule in enumerate(values.rules):
        found = values.disjoint(number)
        if found is not None and not rule.head.term.location.begin.filename.startswith("<"):
            name, atom, its, other, others = found
            message = f"the rule never applies: no {name} fits both {term_text(other.term)} and {term_text(atom.term)}"
            remedy = f"it is {_listed(others)} in the first, {_listed(its)} in the second"
            yield fault_at(atom.term, "no-match", message, remedy)


def _listed(values: Iterable[clingo.Symbol]) -> str:
    known = sorted(format_pattern(one) for one in values)
    return ", ".join(known[:MANY]) + " ..." * (len(known) > MANY)


def unfounded_predicates(survey: Survey, values: ArgumentValues) -> List[Fault]:
    """Return the predicates that are never true because their rules depend on each other in a circle."""
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
        message = (
            f"{signature} is never true: its rules need {names} in a circle, without a fact or choice to start from"
        )
        places = [*survey.defining.get(signature, ()), *survey.declaring.get(signature, ())]
        found.append(places[0].fault("unfounded", message, "add a fact or rule that starts it"))
    return found


# ---- rules that derive nothing --------------------------------------------------------------------------------------


def rules_without_effect(survey: Survey) -> Iterator[Fault]:
    """Yield contradictory bodies, rules with their head in the body, and equations of two bound variables."""
    for _, statement, _ in survey.statements:
        body = [one for one in getattr(statement, "body", ()) if isinstance(one, Node)]
        literals = [one for one in body if one.ast_type == ASTType.Literal]
        plain = {str(one.atom): one for one in literals if is_plain_atom(one)}
        for one in literals:
            atom = term_text(one.atom)
            if one.sign == Sign.Negation and one.atom.ast_type == ASTType.SymbolicAtom and str(one.atom) in plain:
                message = f"the body never holds: it contains {atom} and not {atom}"
                yield fault_at(one, "contradiction", message, "remove one of them")
            elif one.sign == Sign.NoSign and one.atom.ast_type == ASTType.Comparison and len(one.atom.guards) == 1:
                yield from _odd_comparison(one, plain.values())
        if statement.ast_type == ASTType.Rule and is_plain_atom(statement.head) and str(statement.head.atom) in plain:
            message = f"the rule derives nothing: it requires its own head {term_text(statement.head.atom)}"
            yield fault_at(statement.head, "tautology", message, "did you mean another step in the body?")


def _odd_comparison(literal: Node, atoms: Iterable[Node]) -> Iterator[Fault]:
    """Yield a fault if a comparison is one of a term with itself, or an equation of two variables bound by atoms."""
    left, guard = literal.atom.term, literal.atom.guards[0]
    if guard.comparison in _STRICT and str(left) == str(guard.term) != "_":
        yield fault_at(
            literal, "contradiction", f"{term_text(literal.atom)} never holds", "compare it with something else"
        )
    names = [one.name for one in (left, guard.term) if one.ast_type == ASTType.Variable]
    equation = guard.comparison == ComparisonOperator.Equal and len(names) == 2
    # conditions of control programs can only compare a parameter by an equation
    meant = not equation or literal.location.begin.filename.endswith(".golog")
    if not meant and set(names) <= {name for one in atoms for name in names_in(one)}:
        message = f"{names[0]} = {names[1]} equates two variables that atoms bind"
        remedy = f"write {names[0]} instead of {names[1]}, or {names[0]} != {names[1]}"
        yield fault_at(literal, "same-variables", message, remedy)


_STRICT = (ComparisonOperator.NotEqual, ComparisonOperator.LessThan, ComparisonOperator.GreaterThan)
