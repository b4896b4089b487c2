"""Checks for names in place of numbers."""

from typing import Dict, Iterator, List, Sequence

import clingo
from clingo.ast import AggregateFunction, ASTType, UnaryOperator

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.constants import own_constants
from rosoclingo.oclingo.program.likeness import likely_word
from rosoclingo.oclingo.program.nodes import Node, fault_at
from rosoclingo.oclingo.program.survey import Survey


def names_used_as_numbers(survey: Survey) -> List[Fault]:
    """Return the names in rules that are used as numbers although no ``#const`` defines them."""
    own = own_constants(survey)
    found: Dict[str, Fault] = {}
    for part, statement, _ in survey.statements:
        # constants and the parameter of the part are numbers
        known = {*own, *survey.constants, part.parameter}
        for term in _counted(statement.nodes):
            name = _word(term)
            if name and name not in known:
                message = f"{name} is used as a number, but no #const defines it"
                remedy = likely_word(name, own) or f"write #const {name} = 1. with its value"
                fault = fault_at(term, "no-number", message, remedy)
                found.setdefault(f"{fault.file}:{fault.line}:{name}", fault)
    return list(found.values())


def _word(term: Node) -> str:
    if term.ast_type == ASTType.Function and not term.arguments and not term.external:
        return str(term.name)
    symbol = term.symbol if term.ast_type == ASTType.SymbolicTerm else None
    plain = symbol is not None and symbol.type is clingo.SymbolType.Function and not symbol.arguments and symbol.name
    return str(symbol.name) if plain and symbol is not None else ""


def _counted(nodes: Sequence[Node]) -> Iterator[Node]:
    """Yield the terms of a statement that must be numbers."""
    for node in nodes:
        kind = node.ast_type
        if kind in (ASTType.BinaryOperation, ASTType.Interval):
            yield from (node.left, node.right)
        elif kind == ASTType.UnaryOperation and node.operator_type != UnaryOperator.Minus:
            yield node.argument
        elif kind in (ASTType.Aggregate, ASTType.HeadAggregate) or (
            kind == ASTType.BodyAggregate and node.function in _COUNTING
        ):
            yield from (guard.term for guard in (node.left_guard, node.right_guard) if guard is not None)


_COUNTING = (AggregateFunction.Count, AggregateFunction.Sum, AggregateFunction.SumPlus)  # other guards can be words
