"""Values of a program's constants, and checks of values that users set by name."""

from typing import Dict, Iterable, List, Mapping, Optional, Sequence, Set

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.likeness import likely_word
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.signatures import evaluate
from rosoclingo.oclingo.program.survey import Survey


def constant_values(
    parts: Sequence[Part], given: Mapping[str, clingo.Symbol], control: Optional[clingo.Control]
) -> Dict[str, clingo.Symbol]:
    """Return the values of a program's constants; ``given`` values take precedence over definitions.

    Pass no ``control`` if clingo rejects the program. Then only constants with simple definitions have values.
    """
    definitions = [one for part in parts for one in part.statements if one.ast_type == ASTType.Definition]
    if control is None:
        return {**_values_of(definitions, given), **given}
    values = {name: control.get_const(name) for name in {*given, *(one.name for one in definitions)}}
    return {name: value for name, value in values.items() if value is not None}


def _values_of(definitions: Iterable[Node], given: Mapping[str, clingo.Symbol]) -> Dict[str, clingo.Symbol]:
    """Return the values of ``#const`` statements that are simple terms."""
    found: Dict[str, clingo.Symbol] = {}
    for one in definitions:
        value = evaluate(one.value, {**found, **given})
        found.update({} if value is None else {one.name: value})
    return found


def own_constants(survey: Survey) -> Dict[str, Node]:
    """Return the program's ``#const`` statements by name."""
    return {one.name: one for _, one, _ in survey.statements if one.ast_type == ASTType.Definition}


def check_given_values(survey: Survey, given: Mapping[str, clingo.Symbol]) -> List[Fault]:
    """Return faults of the values that users set for constants by name."""
    found: List[Fault] = []
    definitions = own_constants(survey)
    own = _values_of(definitions.values(), {})
    numbers = {name: value for name, value in own.items() if value.type is clingo.SymbolType.Number}
    mentioned = {*definitions, *(_mentioned(survey) if given.keys() - definitions.keys() else ())}
    for name, value in given.items():
        place = f"constant {name}"
        if name in numbers:
            begin = definitions[name].location.begin
            own_value = f"{numbers[name]} ({begin.filename}:{begin.line})"
            message = f"{name} is {value}, but the program's own value is {own_value}"
            if value.type is not clingo.SymbolType.Number:
                found.append(Fault(place, 0, 0, message, "give a number", "constant-value"))
            elif value.number < 0 < numbers[name].number:
                found.append(Fault(place, 0, 0, message, "did you mean a negative number?", "negative-constant"))
        elif name not in mentioned:
            known = f"its constants are {', '.join(sorted(definitions))}" if definitions else "it has none"
            remedy = likely_word(name, definitions) or known
            found.append(Fault(place, 0, 0, f"the program has no #const {name}", remedy, "unknown-constant"))
    return found


def _mentioned(survey: Survey) -> Set[str]:
    """Return the names of all constants that occur in statements."""
    nodes = (node for _, statement, _ in survey.statements for node in statement.nodes)
    symbols = (node.symbol for node in nodes if node.ast_type == ASTType.SymbolicTerm)
    return {one.name for one in symbols if one.type is clingo.SymbolType.Function and not one.arguments}
