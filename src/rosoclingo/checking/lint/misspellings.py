"""Checks for constants and variables that occur once and look like misspelt others."""

from collections import Counter
from typing import Dict, Iterator, List, Set, Tuple

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.likeness import did_you_mean, is_misspelling
from rosoclingo.oclingo.program.literals import names_in
from rosoclingo.oclingo.program.nodes import Node, fault_at
from rosoclingo.oclingo.program.signatures import arguments_of, atoms_in, term_signature
from rosoclingo.oclingo.program.survey import LABELS, Survey
from rosoclingo.oclingo.progression.terms import Signature

_DIGITS = "0123456789"

_Places = List[Tuple[Node, Node]]
"""The occurrences of a name: statements and terms."""

_Names = Dict[str, _Places]


def misspelt_names(survey: Survey) -> List[Fault]:
    """Return the constants and variables that occur once and resemble others.

    Constants that are also names of predicates are left out, as in ``golog_holds(asleep,t) :- asleep(t)``.
    """
    constants: _Names = {}
    variables: _Names = {}
    for part, statement, _ in survey.statements:
        for name, node in _constants(statement):
            if name != part.parameter:
                constants.setdefault(name, []).append((statement, node))
        for node in statement.nodes:
            if node.ast_type == ASTType.Variable and node.name != "_":
                variables.setdefault(node.name, []).append((statement, node))
    predicates = {one.signature.name for _, _, found in survey.statements for one in found}
    values = [one for one in survey.constants if len(one) > 1]
    return [*_lower_case(constants), *_slips(constants, predicates, values), *_slips_of_variables(variables)]


def _constants(statement: Node) -> Iterator[Tuple[str, Node]]:
    """Yield the constants without arguments in a statement."""
    for node in statement.nodes if statement.location.begin.filename != LABELS else ():
        symbol = node.symbol if node.ast_type == ASTType.SymbolicTerm else None
        if symbol is not None and symbol.type is clingo.SymbolType.Function and not symbol.arguments and symbol.name:
            yield symbol.name, node


def _lower_case(constants: _Names) -> Iterator[Fault]:
    """Yield the constants that occur in one rule only, which has a variable of this name."""
    for name, places in constants.items():
        variable, statement = name[:1].upper() + name[1:], places[0][0]
        alone = statement.ast_type == ASTType.Rule and all(one is statement for one, _ in places)
        if alone and variable in names_in(statement):
            message = f"{name} is a constant that occurs only in this rule, which has a variable {variable}"
            yield from (fault_at(node, "lower-case", message, did_you_mean(variable)) for _, node in places)


def _slips(constants: _Names, predicates: Set[str], values: List[str]) -> Iterator[Fault]:
    """Yield lone constants that resemble a frequent one, one of a longer row, or a ``#const`` in ``values``."""
    rows = Counter(name.rstrip(_DIGITS) for name in constants)
    known = constants.keys() - predicates
    for name, places in constants.items():
        if len(places) > 1 or name not in known or name in values:
            continue
        near = [one for one in values if is_misspelling(name, one)]
        for one in (other for other in known - set(values) if is_misspelling(name, other)):
            longer = rows[one.rstrip(_DIGITS)] >= rows[name.rstrip(_DIGITS)] and _are_apart(places, constants[one])
            if len(constants[one]) > 1 or longer:
                near.append(one)
        if near:
            meant = max(sorted(near), key=lambda one: len(constants.get(one, ())))
            yield fault_at(places[0][1], "misspelt", f"the constant {name} occurs only once", did_you_mean(meant))


def _are_apart(one: _Places, other: _Places) -> bool:
    """Return whether two names are arguments of predicates, and never in the same position."""
    mine, its = set(_arguments(one)), set(_arguments(other))
    return bool(mine and its) and not mine & its


def _arguments(places: _Places) -> Iterator[Tuple[Signature, int]]:
    for statement, node in places:
        for term, _, _ in atoms_in(statement):
            for number, argument in enumerate(arguments_of(term)):
                if any(one is node for one in argument.nodes):
                    yield term_signature(term), number


def _slips_of_variables(variables: _Names) -> Iterator[Fault]:
    often = [name for name, places in variables.items() if len(places) > 2]
    for name, places in variables.items():
        if len(places) == 1:
            other_case = (one for one in often if one.lower() == name.lower() and len(name) > 1)
            near = [*other_case, *(one for one in often if is_misspelling(name, one, shortest=2))]
            meant = max(near, key=lambda one: len(variables[one]), default=None)
            if meant is not None:
                yield fault_at(places[0][1], "misspelt", f"the variable {name} occurs only once", did_you_mean(meant))
