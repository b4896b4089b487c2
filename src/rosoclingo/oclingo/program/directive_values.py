"""What the terms in directives are worth: the program's constants, windows and first steps."""

from typing import Dict, List, Mapping, Optional, Sequence

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.directives import Placed
from rosoclingo.oclingo.program.nodes import parse
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.signatures import evaluate


def constant_values(
    parts: Sequence[Part], given: Mapping[str, clingo.Symbol], control: Optional[clingo.Control]
) -> Dict[str, clingo.Symbol]:
    """Return the values of a program's constants, those that are ``given`` first.

    Without ``control``, where clingo does not take the program, they are what simple definitions say.
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


def number_of(placed: Placed, constants: Mapping[str, clingo.Symbol], faults: List[Fault], **parameters: int) -> int:
    """Return the value of a directive's term under constants and ``parameters``; 1 and a fault for none."""
    values = dict(constants, **{name: clingo.Number(value) for name, value in parameters.items()})
    try:
        terms = parse(f"value({placed.value}).", lambda code, text: None)
    except RuntimeError:
        faults.append(Fault(placed.file, placed.line, 1, f"{placed.value!r} is no term"))
        return 1
    value = evaluate(terms[-1].head.atom.symbol.arguments[0], values)
    if value is None or value.type != clingo.SymbolType.Number:
        mend = "write a number, or a name that a #const gives a number"
        faults.append(Fault(placed.file, placed.line, 1, f"{placed.value!r} is no number", mend))
        return 1
    return value.number
