"""Constants that are not there, and values that those of a program cannot have."""

from typing import Collection, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Set

import clingo
from clingo.ast import AggregateFunction, ASTType, ComparisonOperator, UnaryOperator

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.lint.likeness import likely_word
from rosoclingo.oclingo.program.lint.survey import Survey, fault_at
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import evaluate


class _Constant(NamedTuple):
    """A ``#const`` of the program: where it stands, and its own value, None where that is no simple term."""

    place: str
    value: Optional[clingo.Symbol]


def given_values(survey: Survey, given: Mapping[str, clingo.Symbol]) -> List[Fault]:
    """Return what is wrong with values that are given to a program's constants by name."""
    found: List[Fault] = []
    own = _own(survey)
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
    """Return which of a program's ``own`` constants may be meant by ``name``, or which there are."""
    return likely_word(name, own) or (f"its constants are {', '.join(sorted(own))}" if own else "it has none")


def _compare(place: str, name: str, value: clingo.Symbol, constant: _Constant) -> Iterator[Fault]:
    own = constant.value
    if own is None or own.type is not clingo.SymbolType.Number:
        return
    message = f"{name} is {value}, but the program's own value is {own} ({constant.place})"
    if value.type is not clingo.SymbolType.Number:
        yield Fault(place, 0, 0, message, "give a number", "constant-value")
    elif value.number < 0 < own.number:
        yield Fault(place, 0, 0, message, "is a negative number meant?", "negative-constant")


def _own(survey: Survey) -> Dict[str, _Constant]:
    found: Dict[str, _Constant] = {}
    for _, one, _ in survey.statements:
        if one.ast_type == ASTType.Definition:
            begin = one.location.begin
            values = {name: constant.value for name, constant in found.items() if constant.value is not None}
            found[one.name] = _Constant(f"{begin.filename}:{begin.line}", evaluate(one.value, values))
    return found


def _mentioned(survey: Survey) -> Set[str]:
    """Return the names of all constants in the statements."""
    nodes = (node for _, statement, _ in survey.statements for node in statement.nodes)
    symbols = (node.symbol for node in nodes if node.ast_type == ASTType.SymbolicTerm)
    return {one.name for one in symbols if one.type is clingo.SymbolType.Function and not one.arguments}


# ---- in rules -------------------------------------------------------------------------------------------------------


def words_for_numbers(survey: Survey) -> List[Fault]:
    """Return the names in rules that stand where a number has to be, though no ``#const`` gives them one."""
    own = _own(survey)
    found: Dict[str, Fault] = {}
    for part, statement, _ in survey.statements:
        # a step's parameter and constants are numbers; those of part headers are the parameters of these
        known = {*own, *survey.constants, part.parameter}
        for term in _counted(statement.nodes):
            name = _word(term)
            if name and name not in known:
                message = f"{name} stands for a number, but no #const gives it one"
                fault = fault_at(term, "no-number", message, _mend(name, own))
                found.setdefault(f"{fault.file}:{fault.line}:{name}", fault)
    return list(found.values())


def _mend(name: str, own: Collection[str]) -> str:
    return likely_word(name, own) or f"write #const {name} = 1. with its value"


def _word(term: Node) -> str:
    if term.ast_type == ASTType.Function and not term.arguments and not term.external:
        return str(term.name)
    symbol = term.symbol if term.ast_type == ASTType.SymbolicTerm else None
    plain = symbol is not None and symbol.type is clingo.SymbolType.Function and not symbol.arguments and symbol.name
    return str(symbol.name) if plain and symbol is not None else ""


def _counted(nodes: Sequence[Node]) -> Iterator[Node]:
    """Yield the terms of a statement that have to be numbers."""
    for node in nodes:
        kind = node.ast_type
        if kind in (ASTType.BinaryOperation, ASTType.Interval):
            yield from (node.left, node.right)
        elif kind == ASTType.UnaryOperation and node.operator_type != UnaryOperator.Minus:
            yield node.argument
        elif kind == ASTType.Comparison:
            yield from _ordered(node, nodes)
        elif kind in (ASTType.Aggregate, ASTType.HeadAggregate) or (
            kind == ASTType.BodyAggregate and node.function in _COUNTING
        ):
            yield from _guards(node)


def _ordered(node: Node, nodes: Sequence[Node]) -> Iterator[Node]:
    """Yield what is compared as less or more with what is counted with: a variable that is calculated with, a sum."""
    sides = [node.term, *(guard.term for guard in node.guards)]
    if len(sides) == 2 and node.guards[0].comparison in _ORDERS:
        for one, other in (sides, sides[::-1]):
            if other.ast_type == ASTType.BinaryOperation or str(other) in _calculated(nodes):
                yield one


def _calculated(nodes: Sequence[Node]) -> Set[str]:
    """Return the variables with which a statement calculates."""
    sums = (one for one in nodes if one.ast_type == ASTType.BinaryOperation)
    return {str(side) for one in sums for side in (one.left, one.right) if side.ast_type == ASTType.Variable}


_ORDERS = (
    ComparisonOperator.LessThan,
    ComparisonOperator.LessEqual,
    ComparisonOperator.GreaterThan,
    ComparisonOperator.GreaterEqual,
)
_COUNTING = (AggregateFunction.Count, AggregateFunction.Sum, AggregateFunction.SumPlus)  # other guards may be words


def _guards(node: Node) -> Iterator[Node]:
    for guard in (node.left_guard, node.right_guard):
        if guard is not None:
            yield guard.term
