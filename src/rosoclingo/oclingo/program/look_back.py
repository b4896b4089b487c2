"""The relation of terms to the step: offsets of terms like ``t+1``, bounds of variables in ``t-T < 60``.

A linear term ``a*t + b*T + c`` is a mapping from names to factors, with the constant under the empty name.
"""

from typing import Dict, Iterable, Iterator, Optional, Tuple

import clingo
from clingo.ast import ASTType, BinaryOperator, ComparisonOperator, Sign, UnaryOperator

from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import evaluate

Sum = Dict[str, int]


def time_offsets(arguments: Iterable[Node], parameter: str, constants: Dict[str, clingo.Symbol]) -> Dict[int, int]:
    """Return c for all arguments that equal ``parameter + c`` for a constant c, by position."""
    found: Dict[int, int] = {}
    for position, one in enumerate(arguments if parameter else ()):
        form = linear_form(one, parameter, constants)
        if form is not None and {**form, "": 0} == {parameter: 1, "": 0}:
            found[position] = form.get("", 0)
    return found


def longest_look_back(statement: Node, parameter: str, constants: Dict[str, clingo.Symbol]) -> Dict[str, int]:
    """Return the maximum of t - T for each variable T that comparisons in the body bound.

    The bounds hold for values of T that are numbers; t is the step ``parameter``.
    """
    return _greatest(statement, parameter, constants, 1)


def shortest_look_back(statement: Node, parameter: str, constants: Dict[str, clingo.Symbol]) -> Dict[str, int]:
    """Return the minimum of t - T for each variable T that comparisons in the body bound."""
    return {name: -bound for name, bound in _greatest(statement, parameter, constants, -1).items()}


def _greatest(statement: Node, parameter: str, constants: Dict[str, clingo.Symbol], sign: int) -> Dict[str, int]:
    """Return the maximum of sign * (t - T) for each variable T that comparisons in the body bound."""
    bounds: Dict[str, int] = {}
    for difference, strict in _differences(statement, parameter, constants):
        names = set(difference) - {"", parameter}
        factor = sign * difference.get(parameter, 0)
        # a bound is factor * sign * (t - T) + c <= 0
        if factor > 0 and {sign * difference[name] for name in names} == {-factor} and len(names) == 1:
            bound = (-difference.get("", 0) - strict) // factor
            bounds[min(names)] = min(bound, bounds.get(min(names), bound))
    return bounds


def _differences(statement: Node, parameter: str, constants: Dict[str, clingo.Symbol]) -> Iterator[Tuple[Sum, bool]]:
    """Yield each comparison of the body as a sum that is at most 0, or less than 0 if strict."""
    for left, operator, right in _comparisons(statement):
        sums = linear_form(left, parameter, constants), linear_form(right, parameter, constants)
        if sums[0] is None or sums[1] is None:
            continue
        difference = _plus(sums[0], sums[1], -1)
        for sign, strict in _SIGNS.get(operator, ()):
            yield _plus({}, difference, sign), strict


# for each comparison: signs with which the difference of its sides is at most 0, or below 0 if strict
_SIGNS: Dict[int, Tuple[Tuple[int, bool], ...]] = {
    ComparisonOperator.LessThan: ((1, True),),
    ComparisonOperator.LessEqual: ((1, False),),
    ComparisonOperator.GreaterThan: ((-1, True),),
    ComparisonOperator.GreaterEqual: ((-1, False),),
    ComparisonOperator.Equal: ((1, False), (-1, False)),
}


def _comparisons(statement: Node) -> Iterator[Tuple[Node, int, Node]]:
    """Yield the comparisons of the body as left side, operator and right side."""
    for literal in statement.body if hasattr(statement, "body") else ():
        plain = literal.ast_type == ASTType.Literal and literal.sign == Sign.NoSign
        if plain and literal.atom.ast_type == ASTType.Comparison:
            left = literal.atom.term
            for guard in literal.atom.guards:
                yield left, guard.comparison, guard.term
                left = guard.term


def linear_form(term: Node, parameter: str, constants: Dict[str, clingo.Symbol]) -> Optional[Sum]:
    """Return ``term`` as a sum of names with factors, None if it is not linear."""
    if term.ast_type == ASTType.Variable:
        return {term.name: 1}
    if term.ast_type == ASTType.SymbolicTerm:
        name = str(term.symbol)
        symbol = constants.get(name, term.symbol)
        if name == parameter:
            return {name: 1}
        return {"": symbol.number} if symbol.type == clingo.SymbolType.Number else None
    if term.ast_type == ASTType.UnaryOperation and term.operator_type == UnaryOperator.Minus:
        inner = linear_form(term.argument, parameter, constants)
        return None if inner is None else _plus({}, inner, -1)
    if term.ast_type != ASTType.BinaryOperation:
        return None
    left, right = (linear_form(side, parameter, constants) for side in (term.left, term.right))
    if left is None or right is None:
        return None
    if term.operator_type in (BinaryOperator.Plus, BinaryOperator.Minus):
        return _plus(left, right, 1 if term.operator_type == BinaryOperator.Plus else -1)
    for number, other in ((left, right), (right, left)) if term.operator_type == BinaryOperator.Multiplication else ():
        if set(number) <= {""}:
            return _plus({}, other, number.get("", 0))
    value = evaluate(term, constants)
    return None if value is None else {"": value.number}  # an operation on two numbers yields a number


def _plus(one: Sum, other: Sum, factor: int) -> Sum:
    """Return ``one + factor * other``."""
    found = {name: one.get(name, 0) + factor * other.get(name, 0) for name in {*one, *other}}
    return {name: number for name, number in found.items() if number}
