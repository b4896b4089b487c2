"""Atoms of :mod:`clingo.ast` statements, their signatures, and values of simple terms."""

import operator
from typing import Callable, Dict, Iterator, List, Optional, Sequence, Tuple

import clingo
from clingo.ast import ASTType, BinaryOperator, Sign, UnaryOperator

from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.progression.terms import Signature

Atom = Tuple[Node, bool, bool]
"""The term of an atom, whether it is a head, and whether it is a positive body atom."""


def without_sign(term: Node) -> Node:
    """Return a term without the sign of classical negation."""
    return term.argument if term.ast_type == ASTType.UnaryOperation else term


def arguments_of(atom: Node) -> List[Node]:
    """Return the arguments of an atom's term, with or without classical negation."""
    return list(without_sign(atom).arguments) if without_sign(atom).ast_type == ASTType.Function else []


def term_signature(term: Node) -> Signature:
    """Return the signature of an atom's term."""
    kind = term.ast_type
    if kind == ASTType.UnaryOperation:
        return term_signature(term.argument)._replace(positive=False)
    if kind == ASTType.SymbolicTerm:
        return Signature(term.symbol.name, 0, term.symbol.positive)
    return Signature(term.name, len(term.arguments))


def signature_and_arguments(term: Node) -> Tuple[Signature, List[Node]]:
    """Return the signature and the arguments of an atom's term."""
    return term_signature(term), arguments_of(term)


def atom_terms(term: Node) -> Iterator[Node]:
    """Yield the terms of an atom, one for each alternative of a pool."""
    if term.ast_type == ASTType.Pool:
        for argument in term.arguments:
            yield from atom_terms(argument)
    else:
        yield term


def atoms_in(statement: Node) -> List[Atom]:
    """Return all atoms of ``statement``; in aggregates and conditions, atoms without a sign count as positive."""
    found: List[Atom] = []
    if statement.ast_type == ASTType.Rule:
        if statement.head.ast_type != ASTType.TheoryAtom:
            _collect(statement.head, True, found)
    elif hasattr(statement, "atom"):  # an #external declares its atom, a #heuristic or #project only refers to it
        _note(statement.atom, statement.ast_type == ASTType.External, False, found)
    for literal in getattr(statement, "body", ()):
        _collect(literal, False, found)
    return found


def _collect(node: Node, head: bool, found: List[Atom]) -> None:
    """Collect the atoms of a literal, a condition, an aggregate or one of its elements."""
    if node.ast_type == ASTType.Literal and node.atom.ast_type == ASTType.SymbolicAtom:
        plain = node.sign == Sign.NoSign
        _note(node.atom, head and plain, not head and plain, found)
        return
    inner = node.atom if node.ast_type == ASTType.Literal else node
    if inner.ast_type == ASTType.ConditionalLiteral:
        _collect(inner.literal, head, found)
    condition = getattr(inner, "condition", ())
    if isinstance(condition, Sequence):
        for one in condition:
            _collect(one, False, found)
    else:  # in a head aggregate, the condition is a conditional literal
        _collect(condition, head, found)
    for one in getattr(inner, "elements", ()):
        _collect(one, head, found)


def _note(atom: Node, head: bool, positive: bool, found: List[Atom]) -> None:
    found.extend((term, head, positive) for term in atom_terms(atom.symbol))


def head_literals(head: Node) -> Iterator[Tuple[Node, Sequence[Node]]]:
    """Yield the literals of a head, each with its condition."""
    if head.ast_type == ASTType.Literal:
        yield head, ()
    elif head.ast_type in (ASTType.Disjunction, ASTType.Aggregate, ASTType.HeadAggregate):
        for element in head.elements:
            one = element.condition if element.ast_type == ASTType.HeadAggregateElement else element
            if one.ast_type == ASTType.ConditionalLiteral:
                yield one.literal, list(one.condition)


def evaluate(term: Node, values: Dict[str, clingo.Symbol]) -> Optional[clingo.Symbol]:
    """Return the value of a ground term under constants and parameters, None for undefined or complex terms."""
    if term.ast_type == ASTType.SymbolicTerm:
        symbol = term.symbol
        if symbol.type == clingo.SymbolType.Function and not symbol.arguments and symbol.positive:
            return values.get(symbol.name, symbol)
        return symbol
    if term.ast_type not in (ASTType.UnaryOperation, ASTType.BinaryOperation):
        return None
    unary = term.ast_type == ASTType.UnaryOperation
    parts = [evaluate(part, values) for part in ([term.argument] if unary else [term.left, term.right])]
    numbers = [part.number for part in parts if part is not None and part.type == clingo.SymbolType.Number]
    operation = (_UNARY if unary else _BINARY).get(term.operator_type)
    if operation is None or len(numbers) < len(parts):
        return None
    value = operation(*numbers)
    return clingo.Number(value) if value is not None and -(2**31) <= value < 2**31 else None


def _quotient(a: int, b: int) -> Optional[int]:
    """Return a/b, rounded towards 0 like clingo."""
    return None if b == 0 else abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1)


def _remainder(a: int, b: int) -> Optional[int]:
    quotient = _quotient(a, b)
    return None if quotient is None else a - b * quotient


def _power(a: int, b: int) -> Optional[int]:
    """Return a**b; like clingo, 0 for negative exponents."""
    if b < 0:
        return None if a == 0 else 0
    return a**b if abs(a) < 2 or b < 32 else None


_UNARY: Dict[int, Callable[[int], Optional[int]]] = {
    UnaryOperator.Minus: operator.neg,
    UnaryOperator.Negation: operator.invert,
    UnaryOperator.Absolute: abs,
}
_BINARY: Dict[int, Callable[[int, int], Optional[int]]] = {
    BinaryOperator.Plus: operator.add,
    BinaryOperator.Minus: operator.sub,
    BinaryOperator.Multiplication: operator.mul,
    BinaryOperator.Division: _quotient,
    BinaryOperator.Modulo: _remainder,
    BinaryOperator.Power: _power,
    BinaryOperator.And: operator.and_,
    BinaryOperator.Or: operator.or_,
    BinaryOperator.XOr: operator.xor,
}
