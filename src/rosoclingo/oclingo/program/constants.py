"""Values of a program's constants, and checks of values that users set by name."""

from typing import Collection, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Set

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.likeness import likely_word
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.signatures import evaluate
from rosoclingo.oclingo.program.survey import Survey


def constant_values(
    parts: Sequence[Part], given: Mapping[str, clingo.Symbol], control: Optional[clingo.Control]
) -> Dict[str, clingo.Symbol]:
    """Return the values of a program's constants; ``given`` values take precedence over definitions.

    Pass no ``control`` if clingo rejects the program. Then only constants with simple definitions have values.
    """
    found: Dict[str, clingo.Symbol] = {}
    definitions = [one for part in parts for one in part.statements if one.ast_type == ASTType.Definition]
    if control is not None:
        values = {name: control.get_const(name) for name in {*given, *(one.name for one in definitions)}}
        return {name: value for name, value in values.items() if value is not None}
    for one in definitions:
        value = evaluate(one.value, {**found, **given})
        found.update({} if value is None else {one.name: value})
    return {**found, **given}


class _Constant(NamedTuple):
    """A ``#const`` of the program: its place and its value, None if that is not a simple term."""

    place: str
    value: Optional[clingo.Symbol]


def check_given_values(survey: Survey, given: Mapping[str, clingo.Symbol]) -> List[Fault]:
    """Return faults of the values that users set for constants by name."""
    found: List[Fault] = []
    own = own_constants(survey)
    mentioned = _mentioned(survey) if given.keys() - own.keys() else ()
    for name, value in given.items():
        place = f"constant {name}"
        if name in own:
            found += _compare(place, name, value, own[name])
        elif name not in mentioned:
            message = f"the program has no #const {name}"
            found.append(Fault(place, 0, 0, message, likely_constant(name, own), "unknown-constant"))
    return found


def likely_constant(name: str, own: Collection[str]) -> str:
    """Suggest a similar constant of the program for ``name``; if there is none, list all of them."""
    return likely_word(name, own) or (f"its constants are {', '.join(sorted(own))}" if own else "it has none")


def _compare(place: str, name: str, value: clingo.Symbol, constant: _Constant) -> Iterator[Fault]:
    own = constant.value
    if own is None or own.type is not clingo.SymbolType.Number:
        return
    message = f"{name} is {value}, but the program's own value is {own} ({constant.place})"
    if value.type is not clingo.SymbolType.Number:
        yield Fault(place, 0, 0, message, "give a number", "constant-value")
    elif value.number < 0 < own.number:
        yield Fault(place, 0, 0, message, "did you mean a negative number?", "negative-constant")


def own_constants(survey: Survey) -> Dict[str, _Constant]:
    """Return the program's ``#const`` definitions by name."""
    found: Dict[str, _Constant] = {}
    for _, one, _ in survey.statements:
        if one.ast_type == ASTType.Definition:
            begin = one.location.begin
            values = {name: constant.value for name, constant in found.items() if constant.value is not None}
            found[one.name] = _Constant(f"{begin.filename}:{begin.line}", evaluate(one.value, values))
    return found


def _mentioned(survey: Survey) -> Set[str]:
    """Return the names of all constants that occur in statements."""
    nodes = (node for _, statement, _ in survey.statements for node in statement.nodes)
    symbols = (node.symbol for node in nodes if node.ast_type == ASTType.SymbolicTerm)
    return {one.name for one in symbols if one.type is clingo.SymbolType.Function and not one.arguments}
